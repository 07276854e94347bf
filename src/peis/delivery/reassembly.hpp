// Long messages put together from fragments in any order (peis-wire.md 8.3, P2P-04).
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/link/fair_share.hpp"
#include "peis/wire/package.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

struct reassembly_config {
  std::size_t messages_max = 512;       ///< at once
  std::size_t octets_max = 40UL << 20U; ///< of memory, for all of them together
  duration timeout = 10s;               ///< after the last fragment
};

/// Keyed by source, fragment group and port, so that two senders never mix (a real kernel's do).
/// The messages of a link may take as much of either limit as is free beside them: one link half,
/// so that there is room for those of others.
class reassembly {
public:
  reassembly() = default;
  explicit reassembly(reassembly_config config) : config_(config) {}

  /// What messages take from now on, they take of this too. @pre there are none
  void use_memory(std::shared_ptr<fair_share> memory) { memory_ = std::move(memory); }

  /// Would this fragment be taken? Not when memory is used up, nor when it contradicts the others.
  [[nodiscard]] bool accepts(const package_header& header, link_id over = {}) const;

  /// Adds a fragment; returns the message that it completes. @pre accepts(header), is_legal(header)
  [[nodiscard]] std::optional<bytes> add(const package_header& header, byte_view data, instant now,
                                         link_id over = {});

  /// Forgets what a host has begun to send.
  void drop(peer_id source);

  /// Discards messages whose fragments stopped coming. @returns how many
  std::size_t on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return next_check_; }

  [[nodiscard]] std::size_t size() const { return messages_.size(); }
  [[nodiscard]] std::size_t octets() const { return octets_; } ///< of memory

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
    link_id over; ///< over which it began to come
    bytes octets; ///< grows as far as fragments have come
    std::vector<bool> have;
    instant last;
  };

  static group group_of(const package_header& header);
  struct share {
    std::size_t messages = 0;
    std::size_t octets = 0;
  };

  [[nodiscard]] static std::size_t capacity_for(const partial* x, const package_header& header);
  [[nodiscard]] static std::size_t growth(const partial* x, const package_header& header);
  [[nodiscard]] std::size_t room() const;
  void release(const partial& x);
  std::map<group, partial>::iterator erase(std::map<group, partial>::iterator at);

  reassembly_config config_;
  std::shared_ptr<fair_share> memory_; ///< of this and other tables
  std::map<group, partial> messages_;
  std::map<link_id, share> shares_;
  std::size_t octets_ = 0;
  std::optional<instant> next_check_;
};

} // namespace rubicon::peis
