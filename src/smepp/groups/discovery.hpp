// Which groups are there: the side that asks (SMP-06, SMP-08, SMP-25).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "smepp/actions.hpp"
#include "smepp/crypto/security.hpp"

namespace rubicon::smepp {

struct discovery_config {
  mote_id self;
  /// Between repeats: less than the shortest window of a group, less a frame.
  duration interval = 50ms;
  duration patience = 3s;      ///< until the result; more than the longest management period
  std::size_t groups_max = 8;  ///< found; others are not noted, counted
  std::size_t members_max = 4; ///< who answered, of each group
};

/// A member that has announced a group, and may admit us to it; and what it has sent, which need
/// not be true.
struct found_member {
  mote_id who;
  group_description description; ///< with the master key that it was looked for with, if any
  bool is_proven = false;        ///< it has that key as well
  group_time time;               ///< what it was
  instant received_at;           ///< when that was received
};

struct found_group {
  group_id id;
  std::vector<found_member> members; ///< the best to ask first; never empty
};

/// Asks again and again until the time is over: some of the questions meet a group's active period.
///
/// Each answer stands for who gave it. Those that show the key come first and take the room of
/// others; among the rest a shorter period comes first, so a false one costs no more than a true
/// one.
class discovery {
public:
  discovery() = default;
  explicit discovery(discovery_config config) : config_(config) {}

  /// What was found before is forgotten.
  void ask(const group_filter& x, security& security, instant now);

  void on_answer(mote_id from, const answer& x, instant now);

  void on_time(actions& out, instant now);
  [[nodiscard]] std::optional<instant> deadline() const;
  [[nodiscard]] bool is_asking() const { return search_.has_value(); }

  [[nodiscard]] const found_group* find(group_id group) const;
  [[nodiscard]] std::uint64_t no_room() const { return no_room_; }

private:
  struct search {
    group_filter filter;
    std::uint64_t nonce = 0;
    instant until;
    instant next;
  };

  /// Nothing: it is not what we have asked for.
  [[nodiscard]] std::optional<found_member> read(mote_id from, const answer& x, instant now) const;
  [[nodiscard]] found_group* place_for(group_id group, bool is_proven);

  discovery_config config_;
  std::optional<search> search_;
  std::vector<found_group> found_;
  std::uint64_t no_room_ = 0;
};

} // namespace rubicon::smepp
