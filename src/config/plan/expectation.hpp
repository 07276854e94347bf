// What a file expects of its runs ([[expect]]): what must come true beside the invariants.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::config {

/// Motes that an expectation is about.
struct mote_scope {
  std::string name = "*"; ///< as the file says: `*`, `kitchen` or `kitchen/fan`
  island_id island;       ///< 0: of any island
  mote_id mote;           ///< 0: all of the island

  [[nodiscard]] bool contains(const mote_address& x) const {
    return (island == island_id{} || island == x.island) && (mote == mote_id{} || mote == x.mote);
  }
};

/// Holds while the tuple is one of some texts, or a number within bounds. A tuple that is not there
/// meets no condition.
struct tuple_condition {
  std::string key;                 ///< of any owner; keys have no letter case (TUP-03)
  std::vector<std::string> equals; ///< empty: bounds decide
  std::optional<double> above;     ///< at or above this
  std::optional<double> below;     ///< below this
};

/// Share of the messages offered by programs of these motes that have arrived.
struct delivery_expectation {
  mote_scope of;
  double at_least = 1;
};

/// Share of the reliable messages offered by programs of these motes that were acknowledged.
struct acknowledged_expectation {
  mote_scope of;
  double at_least = 1;
};

/// Share of the records that the writer's program has produced that the reader's has got.
struct stream_expectation {
  std::uint16_t stream = 0;
  mote_address to;     ///< the reader's node; no_mote in the mote part: a PC
  std::string to_name; ///< as the file says
  double at_least = 1;
  std::optional<duration> pause; ///< the longest without a record, from the first to the end
  std::optional<duration> first_within = {}; ///< since both programs were there; unset: `pause`
};

/// Share of what was asked of the inputs of proxies that their motes have acknowledged.
struct actuations_expectation {
  std::string proxy = "*"; ///< prefix of its keys, or all
  std::uint64_t count = 1; ///< minimum number of requests
  double at_least = 1;
};

/// Each time that one tuple comes to be so, another is so within a while; or it is so within that
/// time from the start.
struct tuple_expectation {
  std::optional<tuple_condition> when;
  tuple_condition then;
  duration within{};
};

/// Clocks of motes against that of their sink, whenever they are compared.
struct clock_expectation {
  mote_scope of;
  duration at_most{};
  double share = 1; ///< of the comparisons that must be so good
  duration from = 1min;
  duration every = 10s;
};

/// These motes have joined their island for the first time.
struct joined_expectation {
  mote_scope of;
  duration within{};
};

/// Motes that their gateways list at the end.
struct members_expectation {
  mote_scope of;
  std::optional<std::uint64_t> at_least; ///< unset: all that are to join
};

/// Share of the charge that each of these motes has left at the end.
struct battery_expectation {
  mote_scope of;
  double at_least = 0;
};

/// Share of the time that the radio of each of these motes was on.
struct radio_expectation {
  mote_scope of;
  double at_most = 0;
};

/// Vectors of synaptic channels that a node's programs have missed.
struct vectors_expectation {
  std::string node = "*"; ///< `hall/n-2`, the name of a peer, or all
  std::uint64_t missed = 0;
  duration from{};
};

/// Messages between actors in the whole run: what it costs.
struct events_expectation {
  std::uint64_t at_most = 0;
};

/// Lines of the event log.
struct event_log_expectation {
  std::string text; ///< that they contain
  std::string who;  ///< what their `who` contains; empty: anybody's
  std::uint64_t at_least = 1;
  std::optional<std::uint64_t> at_most;
};

/// Text that a line of the event log contains, and its `who`.
struct event_line {
  std::string text;
  std::string who; ///< empty: anybody's
};

/// A situation that runs of a swarm must come into: a run alone need not.
struct sometimes_expectation {
  std::string name;
  event_line line;                       ///< an empty text: `during` alone
  std::optional<tuple_condition> during; ///< holds at that moment
  std::optional<event_line> after;       ///< the line came at most `within` after this one
  duration within = 1s;
};

using expectation =
    std::variant<delivery_expectation, acknowledged_expectation, stream_expectation,
                 actuations_expectation, tuple_expectation, clock_expectation, joined_expectation,
                 members_expectation, battery_expectation, radio_expectation, vectors_expectation,
                 events_expectation, event_log_expectation, sometimes_expectation>;

} // namespace rubicon::config
