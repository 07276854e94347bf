#include "cli/serial_command.hpp"

#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "actors/forwarder_clients.hpp"
#include "cli/console.hpp"
#include "cli/visit.hpp"
#include "core/codec.hpp"
#include "core/printable.hpp"
#include "io/loop.hpp"
#include "io/serial_port.hpp"
#include "io/signal_watch.hpp"
#include "io/tcp_connect.hpp"
#include "report/figures.hpp"
#include "serial/forwarder.hpp"
#include "serial/host_port.hpp"
#include "serial/packet.hpp"
#include "serial/raw_packet.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t write_room = 64 * 1024;

/// A sink behind a serial port or a serial forwarder.
class sink_source {
public:
  struct callbacks {
    std::function<void(bytes)> on_packet = [](const bytes&) {};
    std::function<void(serial::packet_id, bool acked)> on_done = [](serial::packet_id, bool) {};
  };

  sink_source(const serial_command& with, callbacks x)
      : to_user_(std::move(x)), port_(config_of(with)), start_(clock::now()) {
    if (!with.device.empty())
      open_device(with);
    else
      connect(with);
  }

  [[nodiscard]] instant now() const {
    return instant(std::chrono::duration_cast<duration>(clock::now() - start_));
  }

  /// Why there is no sink any more; empty: there is one, or will be.
  [[nodiscard]] const std::string& lost() const { return lost_; }
  [[nodiscard]] bool is_there() const { return there_; }
  [[nodiscard]] io::loop& loop() { return loop_; }

  /// Lets a forwarder's packets go without an ack of the mote: it tells none.
  void send(serial::packet_id id, bytes packet) {
    if (stream_) {
      stream_->send(serial::encode_forwarded(packet));
      loop_.post([this, id] { to_user_.on_done(id, true); });
    } else {
      perform(port_.send(id, std::move(packet), now()));
    }
  }

  /// Waits for something to happen, until `end` at the latest.
  void step(instant end) {
    const auto until = earliest(port_.deadline(), std::optional(end));
    loop_.wait_until(start_ +
                     std::chrono::duration_cast<clock::duration>(until->time_since_epoch()));
    perform(port_.on_time(now()));
  }

private:
  using clock = std::chrono::steady_clock;

  static serial::host_port_config config_of(const serial_command& x) {
    serial::host_port_config out;
    out.baud = x.baud;
    return out;
  }

  void open_device(const serial_command& with) {
    auto x = io::serial_port::open(loop_, with.device, with.baud, write_room);
    if (auto* why = std::get_if<std::string>(&x)) {
      lost_ = std::move(*why);
      return;
    }
    device_ = std::get<io::serial_port>(std::move(x));
    device_.start(
        {[this](byte_view octets) { perform(port_.on_bytes(octets, now())); },
         [this, name = with.device](const std::string& why) { lost_ = name + ": " + why; }});
    there_ = true;
  }

  void connect(const serial_command& with) {
    const auto name = with.host + ':' + std::to_string(with.port);
    attempt_ = std::make_unique<io::tcp_connect>(
        loop_, with.host, with.port, 5s, [this, name](std::variant<io::tcp_stream, std::string> x) {
          if (const auto* why = std::get_if<std::string>(&x)) {
            lost_ = *why;
            return;
          }
          stream_ = std::make_unique<io::tcp_stream>(std::get<io::tcp_stream>(std::move(x)));
          stream_->start({[this, name](byte_view octets) { on_forwarded(octets, name); },
                          [](std::size_t) {},
                          [this, name](const std::string& why) { lost_ = name + ": " + why; }});
          stream_->send(serial::forwarder_greeting());
        });
  }

  void on_forwarded(byte_view octets, const std::string& name) {
    for (auto& packet : decoder_.on_octets(octets))
      to_user_.on_packet(std::move(packet));
    there_ = decoder_.greeted();
    if (decoder_.refused() != serial::refusal::none)
      lost_ = name + ": " + std::string(to_string(decoder_.refused()));
  }

  void perform(serial::outputs todo) {
    for (auto& output : todo) {
      if (auto* x = std::get_if<serial::to_line>(&output))
        static_cast<void>(device_.send(payload(std::move(x->octets))));
      else if (auto* y = std::get_if<serial::received>(&output))
        to_user_.on_packet(std::move(y->packet));
      else if (const auto* done = std::get_if<serial::sent>(&output))
        loop_.post([this, id = done->id] { to_user_.on_done(id, true); });
      else if (const auto* gone = std::get_if<serial::lost>(&output))
        loop_.post([this, id = gone->id] { to_user_.on_done(id, false); });
    }
  }

  callbacks to_user_;
  io::loop loop_;
  serial::host_port port_;
  clock::time_point start_;
  bool there_ = false;
  std::string lost_;
  io::serial_port device_;
  serial::forwarder_decoder decoder_;
  std::unique_ptr<io::tcp_connect> attempt_;
  std::unique_ptr<io::tcp_stream> stream_;
};

/// What programs that come with TinyOS say, by type and length; empty: it is something else.
std::string meaning_of(const serial::am_packet& x) {
  constexpr std::uint8_t count_type = 6; // of RadioCountToLeds and BlinkToRadio
  constexpr std::uint8_t oscilloscope_type = 0x93;
  byte_reader in(x.payload);
  if (x.am_type == count_type && x.payload.size() == 2)
    return "count " + std::to_string(in.big<std::uint16_t>());
  if (x.am_type == count_type && x.payload.size() == 4) {
    const auto mote = in.big<std::uint16_t>();
    return "mote " + std::to_string(mote) + " count " + std::to_string(in.big<std::uint16_t>());
  }
  if (x.am_type != oscilloscope_type || x.payload.size() < 8 || x.payload.size() % 2 != 0)
    return {};
  static_cast<void>(in.big<std::uint16_t>()); // version
  const auto interval = in.big<std::uint16_t>();
  const auto mote = in.big<std::uint16_t>();
  auto text = "mote " + std::to_string(mote) + " interval " + std::to_string(interval) + " ms, " +
              std::to_string(in.big<std::uint16_t>()) + " so far:";
  while (in.remaining() > 0)
    text += ' ' + std::to_string(in.big<std::uint16_t>());
  return text;
}

std::string hex_text(std::uint64_t x, std::size_t octets) {
  byte_writer out;
  out.big(x);
  const auto all = std::move(out).finish();
  return "0x" + to_hex(byte_view(all).last(octets));
}

/// `3`, `all`, `-` if the frame does not name it; of 8 octets in hexadecimal.
std::string end_text(const serial::raw_end& x) {
  if (!x.address)
    return "-";
  if (x.is_long)
    return hex_text(*x.address, 8);
  return *x.address == serial::am_broadcast ? "all" : std::to_string(*x.address);
}

/// One packet in a line of text.
class packet_line {
public:
  packet_line(instant at, bool colour) : colour_(colour) { text_ = dim(to_text(at)) + "  "; }

  [[nodiscard]] std::string of(const bytes& packet) {
    const auto raw = serial::decode_raw_packet(packet);
    if (const auto x = serial::decode_am_packet(packet))
      add_ends(std::to_string(x->source),
               x->destination == serial::am_broadcast ? "all" : std::to_string(x->destination));
    else if (raw)
      add(*raw);
    if (const auto x = serial::decode_any_packet(packet))
      add(*x);
    else if (raw)
      text_ += raw->body.empty() ? std::string() : "  " + to_hex(raw->body);
    else
      text_ += "no active message  " + to_hex(packet);
    return text_ + '\n';
  }

private:
  [[nodiscard]] std::string dim(const std::string& x) const {
    return colour_ ? "\x1b[2m" + x + "\x1b[0m" : x;
  }
  [[nodiscard]] std::string bold(const std::string& x) const {
    return colour_ ? "\x1b[1m" + x + "\x1b[0m" : x;
  }

  void add_ends(const std::string& source, const std::string& destination) {
    text_ += source + " -> " + destination;
  }

  void add(const serial::raw_frame& x) {
    add_ends(end_text(x.source), end_text(x.destination));
    auto words =
        "  802.15.4 " + std::string(to_string(x.kind)) + ", sequence " + std::to_string(x.sequence);
    if (x.destination.pan)
      words += ", pan " + hex_text(*x.destination.pan, 2);
    if (x.source.pan)
      words += ", from pan " + hex_text(*x.source.pan, 2);
    words += x.asks_ack ? ", asks for an ack" : "";
    words += x.is_pending ? ", has more" : "";
    words += x.is_secured ? ", secured" : "";
    text_ += dim(words);
  }

  void add(const serial::am_packet& x) {
    text_ += "  type " + bold(std::to_string(x.am_type)) +
             dim("  group 0x" + to_hex(bytes{x.group})) + "  " + to_hex(x.payload);
    if (const auto meaning = meaning_of(x); !meaning.empty())
      text_ += "  " + bold(meaning);
  }

  bool colour_;
  std::string text_;
};

/// Numbers of 8 octets as text: JSON's have fewer digits in most programs.
void add_end(nlohmann::ordered_json& out, const std::string& name, const serial::raw_end& x) {
  if (x.pan)
    out[name + "_pan"] = *x.pan;
  if (x.address && x.is_long)
    out[name] = hex_text(*x.address, 8);
  else if (x.address)
    out[name] = *x.address;
}

std::string json_of(const bytes& packet, instant at) {
  nlohmann::ordered_json out;
  out["time_s"] = std::chrono::duration<double>(at.time_since_epoch()).count();
  out["dispatch"] = packet.front();
  const auto raw = serial::decode_raw_packet(packet);
  const auto message = serial::decode_any_packet(packet);
  if (raw) {
    out["frame"] = to_string(raw->kind);
    out["sequence"] = raw->sequence;
    out["asks_ack"] = raw->asks_ack;
    out["pending"] = raw->is_pending;
    out["secured"] = raw->is_secured;
    add_end(out, "destination", raw->destination);
    add_end(out, "source", raw->source);
  } else if (message) {
    out["destination"] = message->destination;
    out["source"] = message->source;
  }
  if (message) {
    out["group"] = message->group;
    out["type"] = message->am_type;
    out["payload"] = to_hex(message->payload);
    if (const auto meaning = meaning_of(*message); !meaning.empty())
      out["meaning"] = meaning;
  } else if (raw) {
    out["body"] = to_hex(raw->body);
  } else {
    out["packet"] = to_hex(packet);
  }
  return out.dump() + '\n';
}

exit_status perform(const serial_command& with, const listen_serial& x) {
  const bool colour = console_of(stdout).colour;
  std::uint64_t count = 0;
  bool written = true;
  bool over = false;
  sink_source* source = nullptr;
  const auto on_packet = [&](const bytes& packet) {
    if (over)
      return;
    const auto at = source->now();
    written = print(stdout, x.json ? json_of(packet, at) : packet_line(at, colour).of(packet));
    over = !written || ++count == x.count;
  };
  sink_source from(with, {on_packet, [](serial::packet_id, bool) {}});
  source = &from;
  bool interrupted = false;
  const io::signal_watch signals(from.loop(), [&](int) { over = interrupted = true; });
  while (!over && from.lost().empty() && !(x.length && from.now() >= instant(*x.length)))
    from.step(x.length ? instant(*x.length) : from.now() + 1s);
  if (!written)
    return exit_status::refused;
  if (interrupted)
    return exit_status::interrupted;
  if (!over && !from.lost().empty())
    return fail(from.lost());
  return x.count && count < *x.count ? fail("only " + report::counted(count, "packet"))
                                     : exit_status::good;
}

exit_status perform(const serial_command& with, const send_serial& x) {
  serial::am_packet packet;
  packet.destination = x.destination;
  packet.group = x.group;
  packet.am_type = x.am_type;
  packet.payload = x.payload;
  std::optional<bool> acked;
  sink_source to(with,
                 {[](const bytes&) {}, [&acked](serial::packet_id, bool good) { acked = good; }});
  while (!to.is_there() && to.lost().empty())
    to.step(to.now() + 1s);
  if (to.lost().empty())
    to.send(serial::packet_id{1}, serial::encode(packet));
  while (!acked && to.lost().empty())
    to.step(to.now() + 1s);
  if (!to.lost().empty())
    return fail(to.lost());
  if (!*acked)
    return fail("the sink has not acknowledged it");
  return answer(with.device.empty() ? "handed to the forwarder\n" : "acknowledged\n");
}

exit_status perform(const serial_command& with, const forward_serial& x) {
  std::unique_ptr<forwarder_clients> clients;
  std::map<std::uint64_t, std::uint64_t> senders; // by packet id
  std::uint64_t next = 1;
  sink_source sink(with, {[&](const bytes& packet) {
                            if (clients)
                              clients->forward(packet);
                          },
                          [&](serial::packet_id id, bool) {
                            const auto sender = senders.extract(id.value);
                            if (clients && !sender.empty())
                              clients->done(sender.mapped());
                          }});
  auto found = forwarder_clients::open(sink.loop(), x.address, x.port,
                                       {[&](std::uint64_t client, bytes packet) {
                                          senders[next] = client;
                                          sink.send(serial::packet_id{next++}, std::move(packet));
                                        },
                                        [](const std::string& what) {
                                          static_cast<void>(
                                              print(stderr, "rubicon: " + printable(what) + '\n'));
                                        }});
  if (const auto* why = std::get_if<std::string>(&found))
    return fail(*why);
  clients = std::get<std::unique_ptr<forwarder_clients>>(std::move(found));
  bool interrupted = false;
  const io::signal_watch signals(sink.loop(), [&](int) { interrupted = true; });
  while (!interrupted && sink.lost().empty() && !(x.length && sink.now() >= instant(*x.length)))
    sink.step(x.length ? instant(*x.length) : sink.now() + 1s);
  clients.reset();
  if (interrupted)
    return exit_status::interrupted;
  return sink.lost().empty() ? exit_status::good : fail(sink.lost());
}

} // namespace

exit_status perform(const serial_command& x) {
  return std::visit([&x](const auto& what) { return perform(x, what); }, x.what);
}

} // namespace rubicon::cli
