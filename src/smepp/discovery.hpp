// Which groups are there: the side that asks (SMP-06, SMP-08, SMP-25).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "smepp/actions.hpp"
#include "smepp/security.hpp"

namespace rubicon::smepp {

struct discovery_config {
  mote_id self;
  /// Between repeats: less than the shortest window of a group, less a frame.
  duration interval = 50ms;
  duration patience = 3s;      ///< until the result; more than the longest management period
  std::size_t groups_max = 8;  ///< found; others are not noted, counted
  std::size_t members_max = 4; ///< who answered, of each group
};

/// A group that somebody has told of.
struct found_group {
  group_id id;
  group_description description; ///< with the master key that it was looked for with, if any
  std::vector<mote_id> members;  ///< who answered: each may admit us
  group_time time;               ///< what it was
  instant told_at;               ///< then
};

/// Asks again and again until the time is over: some of the questions meet a group's active period.
class discovery {
public:
  discovery() = default;
  explicit discovery(discovery_config config) : config_(config) {}

  /// What was found before is forgotten. @pre a counter is left
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
    std::uint32_t nonce = 0;
    instant until;
    instant next;
  };

  /// Nothing: it is not what we have asked for.
  [[nodiscard]] std::optional<group_description> description_of(mote_id from,
                                                                const answer& x) const;

  discovery_config config_;
  std::optional<search> search_;
  std::vector<found_group> found_;
  std::uint64_t no_room_ = 0;
};

} // namespace rubicon::smepp
