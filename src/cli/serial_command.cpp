#include "cli/serial_command.hpp"

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "actors/serial/forwarder_clients.hpp"
#include "cli/network/session.hpp"
#include "cli/print/console.hpp"
#include "cli/sink_source.hpp"
#include "core/codec.hpp"
#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "io/process/signal_watch.hpp"
#include "report/figures.hpp"
#include "serial/meaning.hpp"
#include "serial/packet.hpp"
#include "serial/raw_packet.hpp"

namespace rubicon::cli {

namespace {

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

/// The active message in a packet. Of one with more octets than its header says it is what the
/// header says, as motes take it (docs/tinyos.md 1.4).
std::optional<serial::am_packet> message_in(byte_view packet) {
  constexpr std::size_t length_at = 5;
  auto x = serial::decode_any_packet(packet);
  if (!x && x.error() == errc::too_long && packet.front() != serial::raw_dispatch &&
      packet[length_at] <= serial::am_payload_max)
    x = serial::decode_any_packet(packet.first(1 + serial::am_header_octets + packet[length_at]));
  return x ? std::optional(*std::move(x)) : std::nullopt;
}

/// One packet in a line of text.
class packet_line {
public:
  packet_line(instant at, bool colour) : colour_(colour) { text_ = dim(to_text(at)) + "  "; }

  [[nodiscard]] std::string of(const bytes& packet) {
    const auto raw = serial::decode_raw_packet(packet);
    const auto message = message_in(packet);
    if (raw)
      add(*raw);
    else if (message)
      add_ends(std::to_string(message->source), message->destination == serial::am_broadcast
                                                    ? "all"
                                                    : std::to_string(message->destination));
    if (!packet.empty() && packet.front() == serial::cc1000_dispatch && message)
      text_ += dim("  CC1000");
    if (message)
      add(*message);
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
    if (const auto meaning = serial::meaning_of(x); !meaning.empty())
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
  const auto message = message_in(packet);
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
    if (const auto meaning = serial::meaning_of(*message); !meaning.empty())
      out["meaning"] = meaning;
  } else if (raw) {
    out["body"] = to_hex(raw->body);
  } else {
    out["packet"] = to_hex(packet);
  }
  return json_line(out) + '\n';
}

void print_news(const std::string& what) {
  say("rubicon: " + what);
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
  sink_source from(with, sink_source::patience::for_a_sink,
                   {.on_packet = on_packet, .on_news = print_news});
  source = &from;
  bool interrupted = false;
  const io::signal_watch signals(from.loop(), [&](int) { over = interrupted = true; });
  while (!over && !(x.length && from.now() >= instant(*x.length)))
    from.step(x.length ? instant(*x.length) : from.now() + 1s);
  if (!written)
    return exit_status::refused;
  if (interrupted)
    return exit_status::interrupted;
  if (!over && !from.lost().empty()) // it has said why
    return exit_status::failed;
  return x.count && count < *x.count ? fail("only " + report::counted(count, "packet"))
                                     : exit_status::good;
}

std::string too_long_text(std::size_t payload_max) {
  return "a payload of more than " + std::to_string(payload_max) +
         " octets is refused: a BaseStation compiled for less accepts nothing after it; use "
         "--payload if the mote accepts longer ones";
}

exit_status perform(const serial_command& with, const send_serial& x) {
  serial::am_packet packet;
  packet.destination = x.destination;
  packet.group = x.group;
  packet.am_type = x.am_type;
  packet.payload = x.payload;
  if (packet.payload.size() > with.payload_max)
    return fail(too_long_text(with.payload_max));
  bool over = false;
  bool acked = false;
  sink_source to(with, sink_source::patience::none,
                 {.on_done = [&](serial::packet_id, std::optional<serial::lost_cause> why) {
                   over = true;
                   acked = !why;
                 }});
  while (!to.is_there() && to.lost().empty())
    to.step(to.now() + 1s);
  if (to.lost().empty())
    to.send(serial::packet_id{1}, serial::encode(packet));
  while (!over && to.lost().empty())
    to.step(to.now() + 1s);
  if (!to.lost().empty())
    return fail(to.lost());
  if (!acked)
    return fail("the sink did not acknowledge it");
  return answer(with.device.empty() ? "handed to the forwarder\n" : "acknowledged\n");
}

exit_status perform(const serial_command& with, const forward_serial& x) {
  std::unique_ptr<forwarder_clients> clients;
  std::map<std::uint64_t, std::uint64_t> senders; // by packet id
  std::uint64_t next = 1;
  bool is_reported = false; // that a client's packet was refused
  const auto on_packet = [&](const bytes& packet) {
    if (clients)
      clients->forward(packet);
  };
  const auto on_done = [&](serial::packet_id id, std::optional<serial::lost_cause> why) {
    if (why == serial::lost_cause::too_long && !std::exchange(is_reported, true))
      print_news(too_long_text(with.payload_max));
    const auto sender = senders.extract(id.value);
    if (clients && !sender.empty())
      clients->done(sender.mapped());
  };
  sink_source sink(with, sink_source::patience::for_a_sink, {on_packet, on_done, print_news});
  const auto from_client = [&](std::uint64_t client, bytes packet) {
    senders[next] = client;
    sink.send(serial::packet_id{next++}, std::move(packet));
  };
  auto found = forwarder_clients::open(sink.loop(), x.address, x.port, {from_client, print_news});
  if (const auto* why = std::get_if<std::string>(&found))
    return fail(*why);
  clients = std::get<std::unique_ptr<forwarder_clients>>(std::move(found));
  bool interrupted = false;
  const io::signal_watch signals(sink.loop(), [&](int) { interrupted = true; });
  while (!interrupted && !(x.length && sink.now() >= instant(*x.length)))
    sink.step(x.length ? instant(*x.length) : sink.now() + 1s);
  clients.reset();
  if (interrupted)
    return exit_status::interrupted;
  return sink.lost().empty() ? exit_status::good : exit_status::failed;
}

} // namespace

exit_status perform(const serial_command& x) {
  return std::visit([&x](const auto& what) { return perform(x, what); }, x.what);
}

} // namespace rubicon::cli
