#include "smepp/groups/group_description.hpp"

#include <algorithm>

#include "core/codec.hpp"
#include "core/hash.hpp"
#include "smepp/crypto/cipher.hpp"

namespace rubicon::smepp {

namespace {

constexpr duration cycle_max = 65535ms;

} // namespace

bool is_name(std::string_view x, std::size_t max) {
  return !x.empty() && x.size() <= max &&
         std::ranges::all_of(x, [](char c) { return c >= ' ' && c <= '~'; });
}

bool group_description::is_valid() const {
  const auto& [period, length] = management;
  const bool cycle_fits = period == 0s || (length > 0s && length <= period && period <= cycle_max &&
                                           period % 1ms == 0s && length % 1ms == 0s);
  return is_name(name, name_max) && master.has_value() == (is_closed || is_private) && cycle_fits;
}

bool group_filter::matches(const group_description& x) const {
  return (!name || *name == x.name) && (!is_closed || *is_closed == x.is_closed) &&
         (!is_private || *is_private == x.is_private);
}

group_id id_of(std::string_view name, mote_id creator) {
  const auto folded = fold64().add(name).add(creator.value).value();
  return group_id{static_cast<std::uint16_t>(folded % 0xffff + 1)};
}

key credential_of(const group_description& x, const key_pair& network) {
  if (x.master)
    return derive(*x.master, "closed group");
  return derive(network.integrity, "open group", to_bytes(x.name));
}

bytes terms_of(const group_description& x) {
  const auto [period, length] = x.management;
  byte_writer all;
  all.octet(static_cast<std::uint8_t>(suite::aes_ctr_cmac64))
      .octet(static_cast<std::uint8_t>((x.is_closed ? 1 : 0) | (x.is_private ? 2 : 0)))
      .big(static_cast<std::uint16_t>(period / 1ms))
      .big(static_cast<std::uint16_t>(period > 0s ? length / 1ms : 0))
      .append(to_bytes(x.name));
  return all.finish();
}

} // namespace rubicon::smepp
