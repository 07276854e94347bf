// The arithmetic by which session keys come to a peer that joins, and from one pair to the next.
//
// Who holds a group's credential (its master key; in an open group the network's keys) may join.
// Session keys are handed over under a secret that the two agree on there and then (agreement.hpp):
// who records the handshake cannot open it, not even with the credential. Deviation: A-60 names
// symmetric ciphers only; with them alone, who joins could read all that it has recorded since
// somebody else joined, and who has left all that follows.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "smepp/messages.hpp"

namespace rubicon::smepp {

/// What who has computed nothing yet wants back from who asks: that it is there, and has received
/// this lately.
/// @param own of the member's life alone
/// @param turn counts up with time
[[nodiscard]] tag cookie_of(const key& own, mote_id joiner, const join& x, std::uint64_t turn);

/// One attempt to join.
struct handshake {
  mote_id joiner;
  mote_id member;
  join_proof proof;  ///< of the joiner; its MAC is not looked at
  key_share share{}; ///< of the member
  bytes terms;       ///< of the group
};

/// The joiner knows the credential, now, is equipped so, and knows the group by these terms.
[[nodiscard]] tag join_tag(const key& credential, const handshake& x);

/// The member does not let it in, and knows the credential.
[[nodiscard]] tag refuse_tag(const key& credential, const handshake& x, failure why);

/// For the keys in a join_accept: it takes the credential, what both have agreed on for this
/// handshake, and what the member has agreed on with the joiner's identity. So who has recorded it
/// all cannot open it later, and who claims to be another cannot open it at all.
[[nodiscard]] key accept_key(const key& credential, const handshake& x, const key& agreed,
                             const key& with_identity);

/// For the keys in a key_refresh under `old`: it takes both to open it. So who joins cannot open
/// the change that came before it.
[[nodiscard]] key refresh_key(const key& credential, const key_pair& old);

/// @param carrier what else the MAC is to cover
[[nodiscard]] wrapped_keys wrap(const key& under, const session_keys& x, duration send_in,
                                byte_view carrier = {});

/// With another carrier.
void bind_carrier(const key& under, wrapped_keys& x, byte_view carrier);

/// Nothing if it was not wrapped under that key.
[[nodiscard]] std::optional<session_keys> unwrap(const key& under, const wrapped_keys& x,
                                                 byte_view carrier = {});

/// What a join_accept carries besides the keys.
[[nodiscard]] bytes carrier_of(const join_accept& x);

/// @param from the credential makes sure that to know its numbers is not enough
[[nodiscard]] session_keys make_session(const key& credential, session_id id, randomness& from);

/// That who asks for groups knows the master key of one.
[[nodiscard]] tag question_tag(const key& master, std::uint64_t nonce, mote_id asker);

/// That who answers knows it, and has said all that.
[[nodiscard]] tag answer_tag(const key& master, mote_id asker, mote_id sender, const answer& x);

/// Encrypts or decrypts the name of a private group in an answer.
[[nodiscard]] bytes hidden_name(const key& master, mote_id asker, mote_id sender, const answer& x);

} // namespace rubicon::smepp
