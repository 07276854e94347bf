// What waits to be written to one link: five classes, strict order (P2P-02, P2P-03).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "peis/wire/package.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// The octets of a message in two parts, so that a value is never copied to put a head before it.
struct message_octets {
  payload head;
  payload body;

  [[nodiscard]] std::size_t size() const { return head.size() + body.size(); }
  /// Appends `count` octets from `offset` on. @pre they exist
  void append(std::size_t offset, std::size_t count, bytes& out) const;
};

/// A package whose data is a part of a message: all from `offset` on that one package can carry.
struct outgoing_package {
  package_header header; ///< without length and counter: encode() has them as arguments
  std::shared_ptr<const message_octets> content;
  std::size_t offset = 0; ///< at most the content's size
  provenance from = {};

  /// Octets of data. The only source of the header's length, which so cannot disagree with them.
  [[nodiscard]] std::size_t length() const { return std::min(data_max, content->size() - offset); }
};

/// Appends header and data as they leave. @param counter of the link
void encode(const outgoing_package& x, std::uint32_t counter, bytes& out);

/// Classes of a connection's queue, the first goes first.
enum class lane : std::uint8_t { control, acknowledgements, high, normal, bulk };
inline constexpr std::size_t lanes = 5;

/// The origin of what is our own. Other origins are the links over which it, or what it answers,
/// has come.
inline constexpr link_id own_origin{0};

struct queue_limits {
  std::size_t packages = 0; ///< in each class
  /// Of all classes but control, headers included; control has a quarter of it for itself.
  std::size_t octets = std::size_t{1536} * 1024;
};

/// What the queues of all links have together; one may hold as many octets as are free beside them.
struct queues_memory {
  std::size_t octets_max = 0;
  std::size_t octets = 0; ///< of all classes but control

  [[nodiscard]] bool admits(std::size_t held, std::size_t more) const {
    return octets + more <= octets_max && held + more <= octets_max - octets - more;
  }
};

/// Bounded in each class and in octets; what is full refuses the newest. Below control, packages
/// are given up at random as soon as this class and those above are more than half full: with f the
/// share in use, with probability 2 (f - 0.5), as real kernels do (docs/peis-wire.md 8.1).
///
/// Origins take turns within a class. One of them may hold as much as is free beside it, so there
/// is always room for another, and what is given up at random is of those that hold more than
/// others: a neighbour that floods delays and displaces what itself has sent.
class outgoing_queue {
public:
  /// @param memory of all queues; null: this one has only its own limits
  explicit outgoing_queue(queue_limits limits = {}, std::shared_ptr<queues_memory> memory = nullptr)
      : limits_(limits), memory_(std::move(memory)) {}

  /// Would so many packages, together of so many octets with their headers, be taken? Draws from
  /// rng only when more than half full.
  [[nodiscard]] cause admission(lane where, std::size_t count, std::size_t octets, link_id origin,
                                random_stream& rng) const;

  /// May we add one more of our own, that can wait, without early drop?
  [[nodiscard]] bool has_room(lane where) const;

  void push(lane where, outgoing_package x, link_id origin = own_origin);
  [[nodiscard]] std::optional<outgoing_package> pop();

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t octets() const { return octets_ + control_octets_; }
  [[nodiscard]] std::size_t depth(lane where) const {
    return classes_[static_cast<std::size_t>(where)].depth;
  }

private:
  struct stream {
    link_id origin;
    std::deque<outgoing_package> packages;
  };
  /// Streams are there while they have packages.
  struct service_class {
    std::vector<stream> streams;
    std::size_t turn = 0; ///< whose it is
    std::size_t depth = 0;
  };

  [[nodiscard]] static std::size_t held_by(const service_class& x, link_id origin);
  [[nodiscard]] std::size_t at_or_above(lane where) const;
  [[nodiscard]] bool has_memory(std::size_t more) const {
    return octets_ + more <= limits_.octets && (!memory_ || memory_->admits(octets_, more));
  }
  void note_pushed(std::size_t index, std::size_t octets);
  void note_popped(std::size_t index, std::size_t octets);

  queue_limits limits_;
  std::shared_ptr<queues_memory> memory_;
  std::array<service_class, lanes> classes_;
  std::size_t size_ = 0;
  std::size_t octets_ = 0;
  std::size_t control_octets_ = 0;
};

} // namespace rubicon::peis
