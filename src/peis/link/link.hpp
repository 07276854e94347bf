// One link's octet stream: a connect request, then packages without separators
// (docs/peis-wire.md 3.2 to 3.4). The same over every medium.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

inline constexpr std::int32_t protocol_version = 500;
inline constexpr std::size_t connect_request_size = 76;

/// What the initiator of a link says first.
struct connect_request {
  /// Bits of `flags`.
  static constexpr std::uint32_t all_broadcasts = 1; ///< every broadcast goes over this link
  static constexpr std::uint32_t for_bandwidth = 2;
  static constexpr std::uint32_t for_merge = 4;

  std::int32_t version = protocol_version;
  peer_id id;
  std::uint32_t flags = 0;
  std::string network; ///< up to 62 characters

  friend bool operator==(const connect_request&, const connect_request&) = default;
};

/// 76 octets.
[[nodiscard]] bytes encode(const connect_request& request);

/// truncated, or bad_value for a network string without NUL.
[[nodiscard]] result<connect_request> decode_connect_request(byte_view octets);

/// A package as it lies in the stream; `data` is valid until the next call of the decoder.
struct received_package {
  package_header header;
  byte_view data;
};

/// Cuts a stream that arrives in arbitrary pieces into what it consists of. Holds at most one
/// incomplete package, and what keep_rest() keeps.
///
///   feed(piece); while (auto x = next()) ...; if (broken()) close the link
class stream_decoder {
public:
  /// Adds a piece. It must stay valid until next() has returned nothing, or keep_rest() was called.
  void feed(byte_view piece);

  /// The connect request, once it is complete; to be taken first on an acceptor's link.
  [[nodiscard]] std::optional<byte_view> take_connect_request();

  /// The next complete package. Nothing when there is none, or when the stream is broken.
  [[nodiscard]] std::optional<received_package> next();

  /// Copies what is left of the newest piece, so that it need not stay valid.
  void keep_rest();

  /// Octets kept that next() has not given out.
  [[nodiscard]] std::size_t kept() const { return held_.size() - used_; }

  /// Is there anything that next() has not looked at?
  [[nodiscard]] bool has_more() const { return kept() > 0 || !piece_.empty(); }

  /// Wrong sync word, length or id: nothing that follows can be trusted (TCP-06).
  [[nodiscard]] bool broken() const { return broken_; }

private:
  [[nodiscard]] byte_view take(std::size_t count);
  [[nodiscard]] bool available(std::size_t count);

  bytes held_;           ///< an incomplete unit from earlier pieces
  std::size_t used_ = 0; ///< octets of held_ already given out
  byte_view piece_;      ///< what is left of the newest piece
  bool broken_ = false;
};

} // namespace rubicon::peis
