#include "gateway/others/relay.hpp"

#include <cassert>

#include "core/codec.hpp"

namespace rubicon::gateway {

namespace {

enum class relayed : std::uint8_t { message = 1, input = 2, outcome = 3 };

struct encoder {
  byte_writer& out;

  byte_writer& start(relayed x) const { return out.octet(static_cast<std::uint8_t>(x)); }

  void operator()(const relayed_message& x) const {
    start(relayed::message).big(x.source.value).append(network::encode(x.packet));
  }
  void operator()(const relayed_input& x) const {
    assert(x.octets.size() <= network::body_max);
    start(relayed::input).big(x.number).big(x.mote.value).big(x.channel).append(x.octets);
  }
  void operator()(const relayed_outcome& x) const {
    start(relayed::outcome).big(x.number).octet(static_cast<std::uint8_t>(x.outcome));
  }
};

result<relay> decode_message(byte_reader& in) {
  const island_id source{in.big<std::uint32_t>()};
  if (!in.ok())
    return errc::truncated;
  auto packet = network::decode_gateway_packet(in.rest());
  if (!packet)
    return packet.error();
  if (source.value == 0)
    return errc::bad_value;
  return relay(relayed_message{source, *std::move(packet)});
}

result<relay> decode_input(byte_reader& in) {
  relayed_input x;
  x.number = in.big<std::uint32_t>();
  x.mote = mote_id{in.big<std::uint16_t>()};
  x.channel = in.big<std::uint16_t>();
  if (!in.ok())
    return errc::truncated;
  x.octets = to_bytes(in.rest());
  if (x.octets.size() > network::body_max)
    return errc::too_long;
  return relay(std::move(x));
}

result<relay> decode_outcome(byte_reader& in) {
  relayed_outcome x;
  x.number = in.big<std::uint32_t>();
  const auto outcome = in.octet();
  if (!in.ok())
    return errc::truncated;
  if (in.remaining() > 0)
    return errc::too_long;
  if (outcome == static_cast<std::uint8_t>(input_outcome::pending) ||
      outcome > static_cast<std::uint8_t>(input_outcome::unreachable))
    return errc::bad_value;
  x.outcome = static_cast<input_outcome>(outcome);
  return relay(x);
}

} // namespace

bytes encode(const relay& x) {
  byte_writer out;
  std::visit(encoder{out}, x);
  return out.finish();
}

result<relay> decode_relay(byte_view octets) {
  byte_reader in(octets);
  const auto first = in.octet();
  if (!in.ok())
    return errc::truncated;
  switch (static_cast<relayed>(first)) {
  case relayed::message:
    return decode_message(in);
  case relayed::input:
    return decode_input(in);
  case relayed::outcome:
    return decode_outcome(in);
  }
  return errc::unsupported;
}

} // namespace rubicon::gateway
