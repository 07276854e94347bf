// Secured frames: who may read them, who may write them, and that each is taken once (D1.1 3.4.2,
// SMP-02, SMP-03, SMP-14, A-60).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/error.hpp"
#include "core/time.hpp"
#include "network/wire.hpp"
#include "smepp/crypto/cipher.hpp"
#include "smepp/crypto/replay_windows.hpp"
#include "smepp/crypto/session_keys.hpp"
#include "smepp/group_id.hpp"
#include "smepp/rate_limiter.hpp"
#include "smepp/source_table.hpp"

namespace rubicon::smepp {

/// In front of the ciphertext, network byte order, in clear and authenticated:
///
///   uint8 suite | uint8 key number | uint16 group | uint64 counter
///
/// The key number's high half is of the network keys (4 bits that follow from them), its low half
/// the generation of the session keys (0 without a group), modulo 16. Behind the ciphertext stand 8
/// octets of MAC over sender (uint16), receiver (uint16, as the radio has them), header and
/// ciphertext: encrypt-then-MAC.
inline constexpr std::size_t secured_header_size = 12;
inline constexpr std::size_t secured_overhead = secured_header_size + std::tuple_size_v<tag>;

/// Octets of a message in one frame.
inline constexpr std::size_t message_max = network::frame_payload_max - secured_overhead;

struct security_config {
  mote_id self;
  std::uint32_t counter_block = 256; ///< counters taken from the store at a time; > 0
  /// No counter from here on is used: it may be that of a later life.
  std::uint64_t counter_end = std::numeric_limits<std::uint64_t>::max();
  std::size_t windows_max = 24;   ///< senders times groups, and times keys while these change
  std::size_t sources_max = 10;   ///< senders at network level that are remembered
  std::size_t challenges_max = 8; ///< senders that we have asked at a time
  duration challenge_pause = 2s;  ///< until the same sender is asked again
  duration grace = 60s;           ///< for network keys that have been replaced
};

/// Why a frame was not taken.
enum class refusal : std::uint8_t {
  malformed,     ///< too short or too long
  unknown_suite, ///< another cipher than ours: never tried
  unknown_group, ///< not ours
  wrong_key,     ///< no keys of ours have its number: older ones, newer ones, or foreign ones
  tampered,      ///< its MAC is not what our keys give
  replayed,      ///< its counter was seen, or is too old
  unproven,      ///< authentic, but perhaps a recording: its sender has not answered us yet
};
[[nodiscard]] std::string_view to_string(refusal x);

struct security_counters {
  std::uint64_t sealed = 0;
  std::uint64_t opened = 0;
  std::uint64_t macs =
      0; ///< computed for frames that came: the work that unknown senders can cause
  std::uint64_t challenges = 0;                 ///< sent
  std::uint64_t proofs = 0;                     ///< senders who have answered
  std::uint64_t used_up = 0;                    ///< not sent: no counter is left
  std::map<std::string, std::uint64_t> refused; ///< by cause
};
RUBICON_FIELDS(security_counters, sealed, opened, macs, challenges, proofs, used_up, refused);

/// A frame that is authentic.
struct opened_frame {
  group_id group;
  session_id session; ///< of the keys that opened it; 0 at network level
  std::uint64_t counter = 0;
  bytes content;
  bool is_proven = false; ///< and fresh. Never at network level, whose messages carry nonces
};

struct refused_frame {
  refusal why;
  group_id group;
  /// Its key number is that of session keys newer than our best ones, or of others as new: if it is
  /// honest, we have missed a change.
  bool is_ahead = false;
};

using opening = std::variant<opened_frame, refused_frame>;

/// The keys of one mote, its counter and what it knows of others'.
///
/// Both levels secure a frame of a group in one pass: its keys are derived from the network's and
/// the group's, so it takes both pairs to read or write one, at the price of one.
/// Deviation: D1.1 does not say how the levels combine; one around the other would cost 16 octets
/// a frame more.
///
/// A nonce is the sender's id and a counter that never repeats, whichever keys it is used with:
/// counters are taken from the store in blocks, and who starts anew begins with the next block. Who
/// has none left is silent.
///
/// At network level no sender has a window. Answers carry what was asked with; of who asks a table
/// has the counter, so that a recorded question is taken once a minute at most, and answers to one
/// name are rationed.
///
/// Work for a frame that proves wrong: none if header or counter show it; else a MAC for each pair
/// of keys with its number, which is one but for changes of keys, and never more than macs_max.
class security {
public:
  security() = default;
  /// @param counter_reserved what take_store() gave last; 0: never
  security(security_config config, std::uint64_t counter_reserved);

  static constexpr unsigned macs_max = 4; ///< for one frame

  /// Frames under the keys before are accepted for one grace period.
  void set_network_keys(const key_pair& x, instant now);
  [[nodiscard]] bool has_network_keys() const { return !network_.empty(); }
  [[nodiscard]] const key_pair& network_keys() const { return network_.front().keys; }

  void set_group(group_id group, const std::vector<session_keys>& accepted);
  void remove_group(group_id group);

  /// @param session 0 at network level
  /// Errors: unsupported (no such keys), too_long (above message_max), bad_value (no counter left).
  [[nodiscard]] result<bytes> seal(mote_id to, group_id group, session_id session,
                                   byte_view content);

  /// @param to as the radio had it: self or broadcast_mote
  [[nodiscard]] opening open(mote_id from, mote_id to, byte_view octets, instant now);

  /// A number that we have not used and will not use again; nothing: no counter is left.
  [[nodiscard]] std::optional<std::uint64_t> unique();

  /// The store must hold this before anything is sent that was sealed since the last call.
  [[nodiscard]] std::optional<std::uint64_t> take_store();

  /// A frame was not proven, and no answer to us. @returns what to ask its sender with, if anything
  [[nodiscard]] std::optional<std::uint64_t> challenge(mote_id sender, group_id group, instant now);

  /// Whether a challenge in that name may be answered now.
  [[nodiscard]] bool may_prove(mote_id sender, instant now) {
    return proofs_allowed_.take(sender, now);
  }

  /// Whether a question at network level is no recording, as far as we know; then notes it.
  [[nodiscard]] bool is_new_request(mote_id from, const opened_frame& frame, instant now);

  /// Whether what was asked at network level in that name may be answered now.
  [[nodiscard]] bool may_answer(mote_id sender, instant now) { return sources_.take(sender, now); }

  /// A sender has answered. @returns whether with what it was asked: then it is believed from
  /// that frame on
  bool on_proof(mote_id sender, const opened_frame& frame, std::uint64_t nonce);

  /// The sender has shown otherwise that this is its counter now.
  void believe(mote_id sender, group_id group, session_id under, std::uint64_t counter);

  void on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  void count(refusal x) { ++counters_.refused[std::string(to_string(x))]; }
  [[nodiscard]] const security_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t footprint() const;

private:
  struct network_pair {
    key_pair keys;
    std::uint8_t number = 0;
    std::optional<instant> until;
  };
  /// What a frame of this number is opened with.
  struct frame_keys {
    group_id group;
    session_id session;
    key_order order = 0;
    std::uint8_t number = 0;
    key_pair keys;
  };
  struct accepted_keys {
    session_keys session;
    key_order order = 0;
  };
  struct asked {
    mote_id sender;
    group_id group;
    std::uint64_t nonce = 0;
    instant at;
  };

  void derive_all();
  [[nodiscard]] bool is_ahead(group_id group, std::uint8_t number) const;
  [[nodiscard]] std::variant<opened_frame, refusal> try_keys(const frame_keys& keys, mote_id from,
                                                             mote_id to, byte_view octets,
                                                             std::uint64_t counter);
  [[nodiscard]] const frame_keys* sending_keys(group_id group, session_id session) const;

  security_config config_;
  std::uint64_t counter_ = 0; ///< the next one
  std::uint64_t reserved_ = 0;
  bool must_store_ = false;
  std::vector<network_pair> network_; ///< ours, then the one before
  std::map<group_id, std::vector<accepted_keys>> groups_;
  key_order newest_ = 0;         ///< of all session keys that were learned
  std::vector<frame_keys> keys_; ///< derived; those of our network keys first
  replay_windows windows_;
  std::vector<asked> asked_;
  source_table sources_;
  source_table proofs_allowed_{6, 2};
  rate_limiter challenges_allowed_{8, 4s};
  security_counters counters_;
};

} // namespace rubicon::smepp
