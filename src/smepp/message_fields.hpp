// Parts that several messages have in common, and how they are read.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/codec.hpp"
#include "smepp/messages.hpp"

namespace rubicon::smepp {

[[nodiscard]] inline bool is_mote(mote_id x) {
  return x.value >= 1 && x.value <= mote_id_max;
}

/// Reads fields and notes what no sender of ours writes.
class field_reader : public byte_reader {
public:
  using byte_reader::byte_reader;

  void demand(bool good) { good_ = good_ && good; }
  [[nodiscard]] bool good() const { return good_; }

  std::uint8_t flags(std::uint8_t known) {
    const auto x = octet();
    demand((x & ~known) == 0);
    return x;
  }
  mote_id mote() {
    const mote_id x{big<std::uint16_t>()};
    demand(is_mote(x));
    return x;
  }
  group_id group() {
    const group_id x{big<std::uint16_t>()};
    demand(x != network_level);
    return x;
  }
  tag mac() {
    tag x{};
    const auto octets = take(x.size());
    std::ranges::copy(octets, x.begin());
    return x;
  }
  key_share share() {
    key_share x{};
    std::ranges::copy(take(x.size()), x.begin());
    return x;
  }
  bytes sized(std::size_t max) {
    const std::size_t size = octet();
    demand(size <= max);
    return to_bytes(take(size));
  }
  std::string text(std::size_t max) {
    auto x = rubicon::to_string(sized(max));
    demand(x.empty() || is_name(x, max));
    return x;
  }

private:
  bool good_ = true;
};

inline void write_tag(byte_writer& to, const tag& x) {
  to.append(x);
}

inline void write_text(byte_writer& to, std::string_view x, std::size_t max) {
  assert(x.size() <= max);
  to.octet(static_cast<std::uint8_t>(x.size())).append(to_bytes(x));
}

inline void write(byte_writer& to, const session_id& x) {
  to.big(x.generation).big(x.maker.value);
}

[[nodiscard]] inline session_id read_session(field_reader& from) {
  session_id x;
  x.generation = from.big<std::uint16_t>();
  x.maker = from.mote();
  return x;
}

inline void write(byte_writer& to, const wrapped_keys& x) {
  write(to, x.id);
  assert(x.send_in_ms <= wrapped_keys::send_in_max);
  to.octet(static_cast<std::uint8_t>(x.send_in_ms >> 16))
      .big(static_cast<std::uint16_t>(x.send_in_ms))
      .append(x.octets);
  write_tag(to, x.mac);
}

[[nodiscard]] inline wrapped_keys read_wrapped(field_reader& from) {
  wrapped_keys x;
  x.id = read_session(from);
  const std::uint32_t high = from.octet();
  x.send_in_ms = high << 16 | from.big<std::uint16_t>();
  std::ranges::copy(from.take(x.octets.size()), x.octets.begin());
  x.mac = from.mac();
  return x;
}

inline void write(byte_writer& to, const member& x) {
  to.big(x.who.peer.value).big(x.who.transducers).big(x.stamp).octet(x.has_left ? 1 : 0);
  write_tag(to, x.identity);
}

[[nodiscard]] inline member read_member(field_reader& from) {
  member x;
  x.who.peer = from.mote();
  x.who.transducers = from.big<std::uint32_t>();
  x.stamp = from.big<std::uint16_t>();
  x.has_left = from.flags(1) != 0;
  x.identity = from.mac();
  return x;
}

inline void write(byte_writer& to, const subscription_id& x) {
  to.big(x.subscriber.value).octet(x.number);
}

[[nodiscard]] inline subscription_id read_subscription(field_reader& from) {
  subscription_id x;
  x.subscriber = from.mote();
  x.number = from.octet();
  from.demand(x.number > 0);
  return x;
}

} // namespace rubicon::smepp
