#include "smepp/handshake.hpp"

#include <algorithm>

#include "core/codec.hpp"

namespace rubicon::smepp {

namespace {

bytes context_of(const handshake& x) {
  byte_writer all;
  all.big(x.group.value)
      .big(x.joiner.value)
      .big(x.member.value)
      .big(x.nonce)
      .big(x.member_nonce)
      .append(x.share)
      .append(x.member_share);
  return all.finish();
}

bytes context_of(session_id x) {
  byte_writer all;
  all.big(x.generation).big(x.maker.value);
  return all.finish();
}

/// Session pairs are encrypted with a key for each: its only counter blocks begin at 0.
void crypt(const key& under, session_id id, std::span<std::uint8_t> octets) {
  apply_ctr(derive(under, "wrap", context_of(id)), block{}, octets);
}

tag mac_of(const key& under, const wrapped_keys& x) {
  byte_writer all;
  all.append(context_of(x.id)).big(x.send_in_ms).append(x.octets);
  return short_mac(derive(under, "wrap MAC"), all.view());
}

key key_from(byte_view octets) {
  std::array<std::uint8_t, key::size> x{};
  std::ranges::copy(octets.first(x.size()), x.begin());
  return key(x);
}

} // namespace

tag join_tag(const key& credential, const handshake& x, transducer_mask transducers,
             bool is_member) {
  byte_writer all;
  all.append(context_of(x)).big(transducers).octet(is_member ? 1 : 0);
  return short_mac(derive(credential, "join"), all.view());
}

key accept_key(const key& credential, const handshake& x, const key& agreed) {
  return derive(derive(credential, "accept", context_of(x)), "agreed", agreed.reveal());
}

key refresh_key(const key& credential, const key_pair& old) {
  return derive(derive(credential, "refresh", old.confidentiality.reveal()), "refresh",
                old.integrity.reveal());
}

wrapped_keys wrap(const key& under, const session_keys& x, duration send_in) {
  wrapped_keys wrapped;
  wrapped.id = x.id;
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(std::max(send_in, duration{}));
  wrapped.send_in_ms = static_cast<std::uint32_t>(std::min<std::int64_t>(ms.count(), UINT32_MAX));
  std::ranges::copy(x.keys.confidentiality.reveal(), wrapped.octets.begin());
  std::ranges::copy(x.keys.integrity.reveal(), wrapped.octets.begin() + key::size);
  crypt(under, x.id, wrapped.octets);
  wrapped.mac = mac_of(under, wrapped);
  return wrapped;
}

std::optional<session_keys> unwrap(const key& under, const wrapped_keys& x) {
  if (!is_same(x.mac, mac_of(under, x)))
    return std::nullopt;
  auto octets = x.octets;
  crypt(under, x.id, octets);
  return session_keys{x.id, {key_from(octets), key_from(byte_view(octets).subspan(key::size))}};
}

session_keys make_session(const key& credential, session_id id, random_stream& rng) {
  byte_writer drawn;
  for (int i = 0; i < 4; ++i)
    drawn.big(rng.next());
  return {id,
          {derive(credential, "session key", drawn.view()),
           derive(credential, "session MAC", drawn.view())}};
}

tag discovery_tag(const key& master, std::uint32_t nonce, mote_id sender, group_id group) {
  byte_writer all;
  all.big(nonce).big(sender.value).big(group.value);
  return short_mac(derive(master, "discover"), all.view());
}

bytes hidden_name(const key& master, std::uint32_t nonce, mote_id sender, byte_view name) {
  byte_writer context;
  context.big(nonce).big(sender.value);
  auto octets = to_bytes(name);
  apply_ctr(derive(master, "name", context.view()), block{}, octets);
  return octets;
}

} // namespace rubicon::smepp
