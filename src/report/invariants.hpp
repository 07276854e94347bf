// What must hold at the end of every run, whatever its seed and its faults. Each check is a pure
// function from a finished report to the violations it finds.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "report/report.hpp"
#include "report/run_counters.hpp"

namespace rubicon::report {

using violations = std::vector<violation>;

// What must hold all the time, so that whoever sees that it does not says so.

/// Every failure of an actor was asked for by the fault plan.
inline constexpr const char* no_actor_fails = "no actor fails";
/// What the file and the command line ask for is there: ports, groups, programs, files.
inline constexpr const char* requests_are_met = "what was asked for is there";
/// The run has come to its end, and its report covers all of it.
inline constexpr const char* run_is_complete = "the run is complete";

/// Motes know their island's time (CLK-01).
inline constexpr const char* clocks_keep_their_bound = "clocks keep their bound";
inline constexpr duration clock_error_max = 3ms;  ///< where radios are always on
inline constexpr duration clock_excess_max = 1ms; ///< more than a mote says itself
/// No mote is gone, or sends in vain, for longer than healing takes (time_watch.hpp).
inline constexpr const char* nobody_is_silent = "no mote is silent for long";

/// The counters of every island's radios balance: no copy and no request vanishes uncounted.
[[nodiscard]] violations check_radio(const run_report& x);

/// Every message that a program has offered is refused, sent unreliably, or sent reliably; the last
/// has exactly one outcome, with its cause if it has failed, or is still waiting.
[[nodiscard]] violations check_messages(const run_report& x);

/// Each packet that a line to real motes has brought was taken or dropped for a cause, and each
/// input for them was sent, has failed for a cause, or is open.
[[nodiscard]] violations check_real_lines(const run_report& x);

/// No packet of a flow from one mote to another vanishes uncounted, and none arrives or is lost
/// twice. Of a broadcast nothing is known: it arrives at any number of motes.
[[nodiscard]] violations check_flows(const run_report& x);

/// No event of a group vanishes uncounted: it is received, lost for a cause, open, or was in a
/// frame that its receiver has refused.
[[nodiscard]] violations check_groups(const run_report& x);

/// What a mote's radio did, and what its processor did, fills its time to the nanosecond.
[[nodiscard]] violations check_energy(const run_report& x);

/// No proxy reports more outcomes than it had requests.
[[nodiscard]] violations check_actuations(const run_report& x);

/// Every mote that no fault ended is listed at the end: it joined and did not leave. Those that are
/// not to join are left out.
[[nodiscard]] violations check_joined(const run_report& x,
                                      std::span<const mote_address> ended_by_fault);

/// Whom a gateway should list and whom it lists, each in any order.
struct device_list {
  island_id island;
  std::vector<mote_id> expected;
  std::vector<mote_id> actual;
};

/// Every gateway lists exactly the motes it should, each once.
[[nodiscard]] violations check_device_lists(const run_report& x,
                                            std::span<const device_list> lists);

/// What a running peer knows.
struct peer_view {
  peer_id id;
  std::string name;
  std::vector<peer_id> hosts;      ///< itself included, in any order
  std::vector<peer_id> neighbours; ///< at the other ends of its links; some may be in no view
  duration clock_offset{};         ///< network time, as it knows it, minus ecology time
};

/// Every peer knows exactly the hosts that it can reach over links (KH-05, RTE-07). Those that can
/// reach a peer of another process are left out. To be asked only when nothing has changed for a
/// while.
[[nodiscard]] violations check_peers(const run_report& x, std::span<const peer_view> peers);

/// A channel in the table of a mote: it begins, passes or ends there.
struct channel_entry {
  mote_address at;
  mote_address source; ///< where it begins
  std::uint16_t number = 0;
};

/// No mote keeps a channel that its source does not have any more. To be asked only of islands
/// where nothing has happened for as long as channels last without packets. @param all of whole
/// islands
[[nodiscard]] violations check_channels(const run_report& x, std::span<const channel_entry> all);

/// No stream is open at one end and closed at the other for long.
[[nodiscard]] violations check_streams(const run_report& x, std::span<const half_open_stream> all);

/// An island none of whose clocks was set, nor its sink started again, for long.
struct steady_island {
  island_id id;
  bool sleeps = false; ///< its motes' radios do: their clocks hold what they say that they hold
  bool has_gateway = false; ///< which has sent it the network time for long, over a fast line
};

/// Island time is what it is promised to be (CLK-01).
[[nodiscard]] violations check_clocks(const run_report& x, std::span<const steady_island> islands);

/// The RUBICON clock ticks everywhere at once: motes know the network time of their gateway, and
/// peers that know each other agree on it (SYN-11, CLK-06, CLK-08). @param peers as check_peers()
[[nodiscard]] violations check_ticks(const run_report& x, std::span<const steady_island> islands,
                                     std::span<const peer_view> peers);

/// Timeouts that wait at the end are no more than a few for each actor: none is set again and again
/// beside those that are there.
[[nodiscard]] violations check_timers(const run_report& x, std::uint64_t waiting);

/// What the checks above need to know beside the report.
struct run_truth {
  std::vector<mote_address> ended_by_fault;
  std::vector<device_list> device_lists;
  std::vector<peer_view> peers = {}; ///< empty if they have not settled
  std::vector<half_open_stream> half_open = {};
  std::vector<channel_entry> channels = {}; ///< of islands that are quiet
  std::vector<steady_island> steady_islands = {};
};

/// All checks, in the order above.
[[nodiscard]] violations check_all(const run_report& x, const run_truth& truth);

} // namespace rubicon::report
