#include "cli/sink_source.hpp"

#include <utility>
#include <variant>

namespace rubicon::cli {

namespace {

constexpr std::size_t write_room = 64 * 1024;

serial::host_port_config config_of(const serial_command& x) {
  serial::host_port_config out;
  out.baud = x.baud;
  out.payload_max = x.payload_max;
  return out;
}

std::string name_of(const serial_command& x) {
  return x.device.empty() ? x.host + ':' + std::to_string(x.port) : x.device;
}

} // namespace

sink_source::sink_source(const serial_command& with, patience how, callbacks x)
    : with_(with), how_(how), to_user_(std::move(x)), port_(config_of(with)) {
  open();
}

instant sink_source::now() const {
  return instant(std::chrono::duration_cast<duration>(clock::now() - start_));
}

void sink_source::send(serial::packet_id id, bytes packet) {
  if (const auto why = serial::objection_to(packet, with_.payload_max)) {
    report_done(id, why);
  } else if (!with_.device.empty()) {
    perform(port_.send(id, std::move(packet), now()));
  } else if (there_) {
    stream_->send(serial::encode_forwarded(packet));
    report_done(id, std::nullopt);
  } else {
    report_done(id, serial::lost_cause::no_ack);
  }
}

void sink_source::step(instant end) {
  const auto until = earliest(earliest(port_.deadline(), next_try_), std::optional(end));
  loop_.wait_until(start_ + std::chrono::duration_cast<clock::duration>(until->time_since_epoch()));
  perform(port_.on_time(now()));
  if (next_try_ && *next_try_ <= now()) {
    next_try_.reset();
    open();
  }
}

void sink_source::open() {
  if (with_.device.empty())
    connect();
  else
    open_device();
}

void sink_source::open_device() {
  auto x = io::serial_port::open(loop_, with_.device, with_.baud, write_room);
  if (auto* why = std::get_if<std::string>(&x)) {
    lose(std::move(*why));
    return;
  }
  device_ = std::get<io::serial_port>(std::move(x));
  device_->start({[this](byte_view octets) { perform(port_.on_bytes(octets, now())); },
                  [this](const std::string& why) { lose(with_.device + ": " + why); }});
  found();
}

void sink_source::connect() {
  decoder_ = {};
  attempt_ = std::make_unique<io::tcp_connect>(
      loop_, with_.host, with_.port, 5s, [this](std::variant<io::tcp_stream, std::string> x) {
        if (auto* why = std::get_if<std::string>(&x))
          lose(std::move(*why));
        else
          on_stream(std::get<io::tcp_stream>(std::move(x)));
      });
}

void sink_source::on_stream(io::tcp_stream found) {
  stream_ = std::make_unique<io::tcp_stream>(std::move(found));
  stream_->start({[this](byte_view octets) { on_forwarded(octets); }, [](std::size_t) {},
                  [this](const std::string& why) { lose(name_of(with_) + ": " + why); }});
  stream_->send(serial::forwarder_greeting());
}

void sink_source::on_forwarded(byte_view octets) {
  for (auto& packet : decoder_.on_octets(octets))
    to_user_.on_packet(std::move(packet));
  if (decoder_.refused() != serial::refusal::none)
    lose(name_of(with_) + ": " + std::string(to_string(decoder_.refused())));
  else if (!there_ && decoder_.greeted())
    found();
}

void sink_source::found() {
  there_ = true;
  reopening_.on_opened(now());
  if (!std::exchange(lost_, {}).empty())
    to_user_.on_news("has " + name_of(with_));
}

/// Not from within a call of what goes.
void sink_source::lose(std::string why) {
  loop_.post([this, why = std::move(why)] { on_lost(why); });
}

void sink_source::on_lost(const std::string& why) {
  if (next_try_)
    return; // it has reported more than one reason
  there_ = false;
  device_.reset();
  stream_.reset();
  if (how_ == patience::for_a_sink) {
    next_try_ = now() + reopening_.on_closed(now());
    if (lost_ != why)
      to_user_.on_news(why + "; tries again");
  }
  lost_ = why;
}

/// Not from within a call of the user's.
void sink_source::report_done(serial::packet_id id, std::optional<serial::lost_cause> why) {
  loop_.post([this, id, why] { to_user_.on_done(id, why); });
}

void sink_source::perform(serial::outputs todo) {
  for (auto& output : todo) {
    if (auto* x = std::get_if<serial::to_line>(&output)) {
      if (device_) // else it is written again, or given up, by the port
        static_cast<void>(device_->send(payload(std::move(x->octets))));
    } else if (auto* y = std::get_if<serial::received>(&output)) {
      to_user_.on_packet(y->packet);
    } else if (const auto* done = std::get_if<serial::sent>(&output)) {
      report_done(done->id, std::nullopt);
    } else if (const auto* gone = std::get_if<serial::lost>(&output)) {
      report_done(gone->id, gone->cause);
    }
  }
}

} // namespace rubicon::cli
