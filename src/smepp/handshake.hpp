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
#include "core/random.hpp"
#include "smepp/messages.hpp"

namespace rubicon::smepp {

/// One attempt to join: both nonces are used for it alone.
struct handshake {
  group_id group;
  mote_id joiner;
  mote_id member;
  std::uint32_t nonce = 0;
  std::uint32_t member_nonce = 0;
  key_share share{}; ///< of the joiner
  key_share member_share{};
};

/// The joiner knows the credential, now, and is equipped so.
[[nodiscard]] tag join_tag(const key& credential, const handshake& x, transducer_mask transducers,
                           bool is_member);

/// For the keys in a join_accept.
/// @param agreed by both shares
[[nodiscard]] key accept_key(const key& credential, const handshake& x, const key& agreed);

/// For the keys in a key_refresh under `old`: it takes both to open it. So who joins cannot open
/// the change that came before it.
[[nodiscard]] key refresh_key(const key& credential, const key_pair& old);

[[nodiscard]] wrapped_keys wrap(const key& under, const session_keys& x, duration send_in);

/// Nothing if it was not wrapped under that key.
[[nodiscard]] std::optional<session_keys> unwrap(const key& under, const wrapped_keys& x);

/// @param rng stands for the mote's source of randomness; the credential makes sure that to know
/// its numbers is not enough
[[nodiscard]] session_keys make_session(const key& credential, session_id id, random_stream& rng);

/// That its sender knows the master key of a private group (SMP-05): in a question with no group,
/// in an answer with it.
[[nodiscard]] tag discovery_tag(const key& master, std::uint32_t nonce, mote_id sender,
                                group_id group);

/// Encrypts or decrypts the name of a private group in an answer.
[[nodiscard]] bytes hidden_name(const key& master, std::uint32_t nonce, mote_id sender,
                                byte_view name);

} // namespace rubicon::smepp
