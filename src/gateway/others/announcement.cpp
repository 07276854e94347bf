#include "gateway/others/announcement.hpp"

#include "core/codec.hpp"

namespace rubicon::gateway {

namespace {

constexpr std::uint32_t mark = 0x52554247;
constexpr std::uint8_t version = 1;
constexpr std::uint8_t stands_by = 1;
constexpr std::uint8_t leads = 2;

} // namespace

bytes encode(const announcement& x) {
  byte_writer out;
  out.big(mark)
      .octet(version)
      .octet(static_cast<std::uint8_t>(x.form))
      .big(x.island.value)
      .big(x.incarnation);
  if (x.leads)
    out.octet(*x.leads ? leads : stands_by);
  return out.finish();
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
  if (const auto role = in.remaining() > 0 ? in.octet() : 0; role == stands_by || role == leads)
    x.leads = role == leads;
  return x;
}

} // namespace rubicon::gateway
