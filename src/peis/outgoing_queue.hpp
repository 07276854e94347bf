// What waits to be written to one link: five classes, strict order (P2P-02, P2P-03, A-13).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "core/bytes.hpp"
#include "core/random.hpp"
#include "peis/package.hpp"
#include "peis/types.hpp"

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
  package_header header; ///< without length and counter: encode() tells them
  std::shared_ptr<const message_octets> content;
  std::size_t offset = 0; ///< at most the content's size

  /// Octets of data. The only source of the header's length, which so cannot disagree with them.
  [[nodiscard]] std::size_t length() const { return std::min(data_max, content->size() - offset); }
};

/// Appends header and data as they leave. @param counter of the link
void encode(const outgoing_package& x, std::uint32_t counter, bytes& out);

/// Classes of a connection's queue, the first goes first.
enum class lane : std::uint8_t { control, acknowledgements, high, normal, bulk };
inline constexpr std::size_t lanes = 5;

/// Bounded in each class; a full class refuses the newest. Below control, packages are given up at
/// random as soon as this class and those above are more than half full: with f the share in use,
/// with probability 2 (f - 0.5), as real kernels do (peis-wire.md 8.1).
class outgoing_queue {
public:
  explicit outgoing_queue(std::size_t capacity = 0) : capacity_(capacity) {}

  /// Would `count` packages be taken? Throws dice only when more than half full.
  [[nodiscard]] cause admission(lane where, std::size_t count, random_stream& dice) const;

  /// May a sender that can wait add one more, without early drop?
  [[nodiscard]] bool has_room(lane where) const;

  void push(lane where, outgoing_package x);
  [[nodiscard]] std::optional<outgoing_package> pop();

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t depth(lane where) const {
    return packages_[static_cast<std::size_t>(where)].size();
  }

private:
  [[nodiscard]] std::size_t at_or_above(lane where) const;

  std::array<std::deque<outgoing_package>, lanes> packages_;
  std::size_t size_ = 0;
  std::size_t capacity_;
};

} // namespace rubicon::peis
