#include "gateway/announcement.hpp"

#include "core/codec.hpp"

namespace rubicon::gateway {

namespace {

constexpr std::uint32_t mark = 0x52554247;
constexpr std::uint8_t version = 1;

} // namespace

bytes encode(const announcement& x) {
  return byte_writer()
      .big(mark)
      .octet(version)
      .octet(static_cast<std::uint8_t>(x.form))
      .big(x.island.value)
      .big(x.incarnation)
      .finish();
}

result<announcement> decode_announcement(byte_view octets) {
  byte_reader in(octets);
  const auto marked = in.big<std::uint32_t>();
  if (in.ok() && marked != mark)
    return errc::bad_value;
  const auto its_version = in.octet();
  const auto form = in.octet();
  announcement x;
  x.island = island_id{in.big<std::uint32_t>()};
  x.incarnation = in.big<std::uint32_t>();
  if (!in.ok())
    return errc::truncated;
  if (its_version != version || form > static_cast<std::uint8_t>(wire_form::segment) ||
      x.island.value == 0)
    return errc::bad_value;
  x.form = static_cast<wire_form>(form);
  return x;
}

} // namespace rubicon::gateway
