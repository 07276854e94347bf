// Who is in a group, as far as one member knows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/address.hpp"
#include "smepp/messages.hpp"

namespace rubicon::smepp {

/// Entries of all members, those who have left for a while too: so an older word of theirs does not
/// bring them back. All tables of a group become equal: of two entries the newer stamp wins, of
/// equal stamps the one that is there, then the larger mask, then the larger identity. A full table
/// gives up those who have left; else it takes no other.
class member_table {
public:
  enum class change : std::uint8_t {
    none,
    updated,
    joined,
    replaced, ///< it was there, and is another now: by its identity
    left,
    no_room
  };

  explicit member_table(std::size_t capacity = 32) : capacity_(capacity) {}

  change learn(const member& x);

  [[nodiscard]] const member* find(mote_id peer) const;
  [[nodiscard]] bool has(mote_id peer) const; ///< and it has not left
  [[nodiscard]] bool has_room() const;        ///< for somebody new
  [[nodiscard]] std::size_t present() const;
  /// How many present members have lower ids.
  [[nodiscard]] std::size_t rank(mote_id peer) const;
  /// In the order of ids.
  [[nodiscard]] const std::vector<member>& all() const { return all_; }
  [[nodiscard]] std::vector<peer_description> descriptions() const; ///< of those present

  /// Equal for tables with equal entries of those present.
  [[nodiscard]] std::uint16_t digest() const;

  /// For sending: all entries, as many a list as fit.
  [[nodiscard]] std::vector<member_list> lists() const;

  [[nodiscard]] std::size_t footprint() const { return capacity_ * member_list::entry_size; }

private:
  std::size_t capacity_;
  std::vector<member> all_;
};

} // namespace rubicon::smepp
