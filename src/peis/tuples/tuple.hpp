// A tuple: a named value that lives with its owner (docs/peis-wire.md 15, TUP-01, TUP-02).
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/tuples/key.hpp"

namespace rubicon::peis {

/// Network time, whose seconds have 32 bits on the wire (tuple_record.hpp).
struct timestamp {
  std::int64_t seconds = 0;
  std::int32_t microseconds = 0;

  friend auto operator<=>(const timestamp&, const timestamp&) = default;
};

inline constexpr timestamp never{0, 0};      ///< as expiry: lives until deleted
inline constexpr timestamp deleted{1, 0};    ///< as expiry: delete it now (docs/peis-wire.md 15.4)
inline constexpr timestamp any_time{-1, -1}; ///< in patterns

/// Seconds and microseconds are wildcards one by one.
[[nodiscard]] constexpr bool is_wildcard(const timestamp& x) {
  return x.seconds == any_time.seconds || x.microseconds == any_time.microseconds;
}

enum class encoding : std::int32_t { any = -1, text = 0, binary = 1 };

inline constexpr std::string_view text_mimetype = "text/plain";
inline constexpr std::string_view binary_mimetype = "application/octet-stream";
/// How an empty value travels: real kernels know none (TUP-02).
inline constexpr std::string_view empty_mimetype = "x-rubicon/empty";
inline constexpr std::size_t mimetype_length_max = 254;

/// What a user puts into a tuple.
struct tuple_content {
  payload value; ///< text includes its trailing NUL
  std::string mimetype{text_mimetype};
  encoding form = encoding::text;
  std::optional<instant> expiry; ///< when it vanishes everywhere; unset: never
};

[[nodiscard]] tuple_content text_content(std::string_view text,
                                         std::optional<instant> expiry = std::nullopt);
[[nodiscard]] tuple_content binary_content(payload octets,
                                           std::optional<instant> expiry = std::nullopt);

struct tuple {
  peer_id owner;
  peer_id creator; ///< last writer
  key name;
  payload value; ///< as on the wire: text has its trailing NUL; may be empty
  std::string mimetype{text_mimetype};
  encoding form = encoding::text;
  timestamp written;   ///< set by the owner
  timestamp user_time; ///< free for applications
  timestamp expiry = never;
  std::int32_t seqno = 0;        ///< grows with each set by the owner
  std::int32_t append_seqno = 0; ///< appends since the last set; garbage from real kernels
  bool stale = false; ///< last value known of an owner that is gone (TUP-19); not on the wire
  provenance from = {};

  /// The value as characters up to the first NUL.
  [[nodiscard]] std::string_view text() const;
};

/// Tuples never change once they are stored: every reader may keep one.
using tuple_pointer = std::shared_ptr<const tuple>;

/// Which tuples are wanted: what is unset, any_peer, any_time and wildcard parts match
/// everything. Made by default it is D1.1's initAbstractTuple().
struct prototype {
  peer_id owner = any_peer;
  key name;
  peer_id creator = any_peer;
  timestamp written = any_time; ///< seconds and microseconds are wildcards one by one
  timestamp user_time = any_time;
  timestamp expiry = any_time;
  encoding form = encoding::any;
  std::optional<std::string> mimetype; ///< up to mimetype_length_max octets
  std::optional<payload> value; ///< compared by length, then without letter case to the first NUL

  /// All fields must agree; with real kernels, different MIME types match (docs/peis-wire.md 15.7).
  [[nodiscard]] bool matches(const tuple& x) const;
  /// Owner and key alone.
  [[nodiscard]] bool names(const tuple& x) const {
    return (owner == any_peer || owner == x.owner) && name.matches(x.name);
  }

  /// The same subscription, whichever peer repeats it (docs/peis-wire.md 15.6).
  friend bool operator==(const prototype& a, const prototype& b);
};

/// The prototype of all tuples of an owner (or any_peer) under a key or pattern.
[[nodiscard]] prototype prototype_of(peer_id owner, key pattern);

} // namespace rubicon::peis
