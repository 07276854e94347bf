#include "smepp/crypto/handshake.hpp"

#include <algorithm>

#include <openssl/crypto.h>

#include "core/codec.hpp"

namespace rubicon::smepp {

namespace {

bytes context_of(const handshake& x) {
  byte_writer all;
  all.big(x.joiner.value)
      .big(x.member.value)
      .big(x.proof.group.value)
      .big(x.proof.nonce)
      .append(x.proof.cookie)
      .big(x.proof.transducers)
      .octet(x.proof.is_member ? 1 : 0)
      .append(x.proof.share)
      .append(x.proof.identity)
      .append(x.share)
      .append(x.terms);
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

tag mac_of(const key& under, const wrapped_keys& x, byte_view carrier) {
  byte_writer all;
  all.append(context_of(x.id)).big(x.send_in_ms).append(x.octets).append(carrier);
  return short_mac(derive(under, "wrap MAC"), all.view());
}

key key_from(byte_view octets) {
  std::array<std::uint8_t, key::size> x{};
  std::ranges::copy(octets.first(x.size()), x.begin());
  return key(x);
}

} // namespace

tag cookie_of(const key& own, mote_id joiner, const join& x, std::uint64_t turn) {
  byte_writer all;
  all.big(joiner.value).big(x.group.value).big(x.nonce).big(turn);
  return short_mac(derive(own, "cookie"), all.view());
}

tag join_tag(const key& credential, const handshake& x) {
  return short_mac(derive(credential, "join"), context_of(x));
}

tag refuse_tag(const key& credential, const handshake& x, failure why) {
  byte_writer all;
  all.octet(static_cast<std::uint8_t>(why)).append(context_of(x));
  return short_mac(derive(credential, "refuse"), all.view());
}

key accept_key(const key& credential, const handshake& x, const key& agreed,
               const key& with_identity) {
  const auto first = derive(derive(credential, "accept", context_of(x)), "agreed", agreed.reveal());
  return derive(first, "identity", with_identity.reveal());
}

key refresh_key(const key& credential, const key_pair& old) {
  return derive(derive(credential, "refresh", old.confidentiality.reveal()), "refresh",
                old.integrity.reveal());
}

wrapped_keys wrap(const key& under, const session_keys& x, duration send_in, byte_view carrier) {
  wrapped_keys wrapped;
  wrapped.id = x.id;
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(std::max(send_in, duration{}));
  wrapped.send_in_ms =
      static_cast<std::uint32_t>(std::min<std::int64_t>(ms.count(), wrapped_keys::send_in_max));
  std::ranges::copy(x.keys.confidentiality.reveal(), wrapped.octets.begin());
  std::ranges::copy(x.keys.integrity.reveal(), wrapped.octets.begin() + key::size);
  crypt(under, x.id, wrapped.octets);
  wrapped.mac = mac_of(under, wrapped, carrier);
  return wrapped;
}

void bind_carrier(const key& under, wrapped_keys& x, byte_view carrier) {
  x.mac = mac_of(under, x, carrier);
}

std::optional<session_keys> unwrap(const key& under, const wrapped_keys& x, byte_view carrier) {
  if (!is_same(x.mac, mac_of(under, x, carrier)))
    return std::nullopt;
  auto octets = x.octets;
  crypt(under, x.id, octets);
  return session_keys{x.id, {key_from(octets), key_from(byte_view(octets).subspan(key::size))}};
}

bytes carrier_of(const join_accept& x) {
  byte_writer all;
  all.octet(x.members).octet(x.subscriptions);
  write(all, x.time);
  return all.finish();
}

session_keys make_session(const key& credential, session_id id, randomness& from) {
  std::array<std::uint8_t, 32> drawn{};
  from.fill(drawn);
  session_keys made{
      id, {derive(credential, "session key", drawn), derive(credential, "session MAC", drawn)}};
  OPENSSL_cleanse(drawn.data(), drawn.size());
  return made;
}

tag question_tag(const key& master, std::uint64_t nonce, mote_id asker) {
  byte_writer all;
  all.big(nonce).big(asker.value);
  return short_mac(derive(master, "question"), all.view());
}

tag answer_tag(const key& master, mote_id asker, mote_id sender, const answer& x) {
  byte_writer all;
  all.big(x.nonce)
      .big(asker.value)
      .big(sender.value)
      .big(x.group.value)
      .octet(static_cast<std::uint8_t>((x.is_closed ? 1 : 0) | (x.is_private ? 2 : 0)))
      .octet(x.members)
      .big(x.period_ms)
      .big(x.length_ms);
  write(all, x.time);
  all.append(x.name);
  return short_mac(derive(master, "answer"), all.view());
}

bytes hidden_name(const key& master, mote_id asker, mote_id sender, const answer& x) {
  byte_writer context;
  context.big(x.nonce).big(asker.value).big(sender.value).big(x.group.value);
  auto octets = x.name;
  apply_ctr(derive(master, "name", context.view()), block{}, octets);
  return octets;
}

} // namespace rubicon::smepp
