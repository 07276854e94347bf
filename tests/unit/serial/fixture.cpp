#include "unit/serial/fixture.hpp"

#include <stdexcept>
#include <string>

#include "support/catch.hpp"

namespace rubicon::serial::test {

bytes hex(std::string_view text) {
  auto octets = from_hex(text);
  if (!octets)
    throw std::runtime_error("not hexadecimal: " + std::string(text));
  return *octets;
}

std::vector<bytes> hex_list(std::string_view text) {
  std::vector<bytes> parts;
  if (text == "-" || text == "none")
    return parts;
  for (;;) {
    const auto slash = text.find(" / ");
    parts.push_back(hex(text.substr(0, slash)));
    if (slash == std::string_view::npos)
      return parts;
    text.remove_prefix(slash + 3);
  }
}

std::vector<frame> decode_all(byte_view octets) {
  frame_decoder decoder;
  std::vector<frame> frames;
  for (const auto octet : octets)
    if (auto x = decoder.on_octet(octet))
      frames.push_back(std::move(*x));
  return frames;
}

bytes numbered_packet(std::uint32_t number, std::size_t payload_octets) {
  am_packet x;
  x.am_type = static_cast<std::uint8_t>(number * 7);
  x.source = static_cast<std::uint16_t>(number * 31);
  for (unsigned i = 0; i < payload_octets; ++i)
    x.payload.push_back(static_cast<std::uint8_t>(i < 4 ? number >> 8 * i : number * i + i));
  return encode(x);
}

std::uint32_t number_of(byte_view packet) {
  const auto x = decode_am_packet(packet);
  REQUIRE(x);
  REQUIRE(x->payload.size() >= 4);
  std::uint32_t number = 0;
  for (unsigned i = 0; i < 4; ++i)
    number |= std::uint32_t{x->payload[i]} << 8 * i;
  REQUIRE(to_bytes(packet) == numbered_packet(number, x->payload.size()));
  return number;
}

fixture::fixture(line_config config, std::uint64_t seed, host_port_config pc_side)
    : pc([&] {
        pc_side.baud = config.baud;
        pc_side.latency = config.latency;
        return pc_side;
      }()),
      latency(config.latency), cable(config, random_stream(seed)), mote([&] {
        mote_port_config x;
        x.baud = config.baud;
        return x;
      }()) {}

void fixture::perform(const outputs& x) {
  for (const auto& one : x) {
    if (const auto* written = std::get_if<to_line>(&one))
      adapter.push_back({now + latency, direction::to_mote, payload(written->octets)});
    else if (const auto* up = std::get_if<received>(&one))
      at_pc.push_back(up->packet);
    else if (const auto* done = std::get_if<sent>(&one))
      sent_ids.push_back(done->id);
    else
      losses.push_back(std::get<lost>(one));
  }
}

void fixture::perform(const mote_port_outputs& x) {
  for (const auto& one : x) {
    if (const auto* written = std::get_if<to_line>(&one))
      cable.send(direction::to_pc, payload(written->octets), now);
    else
      at_mote.push_back(std::get<received>(one).packet);
  }
}

void fixture::perform(const line_outputs& x) {
  for (const auto& one : x) {
    if (one.towards == direction::to_pc)
      adapter.push_back({now + latency, direction::to_pc, one.octets});
    else
      perform(mote.on_bytes(one.octets.view(), now));
  }
}

void fixture::on_adapter_time() {
  while (!adapter.empty() && adapter.front().due <= now) {
    const auto x = std::move(adapter.front());
    adapter.pop_front();
    if (x.towards == direction::to_pc)
      perform(pc.on_bytes(x.octets.view(), now));
    else
      cable.send(direction::to_mote, x.octets, now);
  }
}

bool fixture::step(instant end) {
  auto due = earliest(cable.deadline(), earliest(pc.deadline(), mote.deadline()));
  if (!adapter.empty())
    due = earliest(due, adapter.front().due);
  if (!due || *due > end) {
    now = std::max(now, end);
    return false;
  }
  now = std::max(now, *due);
  on_adapter_time();
  perform(cable.on_time(now));
  perform(pc.on_time(now));
  perform(mote.on_time(now));
  return true;
}

void fixture::run_until(instant end) {
  while (step(end)) {
  }
}

} // namespace rubicon::serial::test
