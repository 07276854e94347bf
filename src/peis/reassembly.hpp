// Long messages put together from fragments in any order (peis-wire.md 8.3, P2P-04).
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/package.hpp"

namespace rubicon::peis {

struct reassembly_config {
  std::size_t messages_max = 512;       ///< at once
  std::size_t octets_max = 64UL << 20U; ///< of all of them together
  duration timeout = 10s;               ///< after the last fragment
};

/// Keyed by source, fragment group and port, so that two senders never mix (a real kernel's do).
class reassembly {
public:
  reassembly() = default;
  explicit reassembly(reassembly_config config) : config_(config) {}

  /// Would this fragment be taken? Not when memory is used up, nor when it contradicts the others.
  [[nodiscard]] bool accepts(const package_header& header) const;

  /// Adds a fragment; returns the message that it completes. @pre accepts(header), is_legal(header)
  [[nodiscard]] std::optional<bytes> add(const package_header& header, byte_view data, instant now);

  /// Forgets what a host has begun to send.
  void drop(peer_id source);

  /// Discards messages whose fragments stopped coming. @returns how many
  std::size_t on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return next_check_; }

  [[nodiscard]] std::size_t size() const { return messages_.size(); }

private:
  struct group {
    peer_id source;
    std::uint16_t seqid = 0;
    std::uint16_t port = 0;

    friend auto operator<=>(const group&, const group&) = default;
  };

  struct partial {
    std::uint16_t fragments = 0;
    std::uint16_t missing = 0;
    bytes octets; ///< grows as far as fragments have come
    std::vector<bool> have;
    instant last;
  };

  static group group_of(const package_header& header);
  [[nodiscard]] static std::size_t growth(const partial* x, const package_header& header);
  std::map<group, partial>::iterator erase(std::map<group, partial>::iterator at);

  reassembly_config config_;
  std::map<group, partial> messages_;
  std::size_t octets_ = 0;
  std::optional<instant> next_check_;
};

} // namespace rubicon::peis
