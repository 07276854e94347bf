// What is to be seen of a run while it runs: samples of motes and islands, and writes of tuples;
// and how much of them is kept for drawings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// Whom a mote hears.
struct neighbour_sample {
  mote_id mote;
  std::optional<double> etx = {}; ///< expected transmissions to it
};

/// Charge that each part of a mote has used so far. [mAh]
struct energy_sample {
  double radio_off = 0;
  double radio_listen = 0; ///< radio on, nothing on the air
  double radio_receive = 0;
  double radio_transmit = 0;
  double processor = 0;
};

/// A mote at one moment.
struct mote_sample {
  mote_address address;
  bool alive = false;
  bool flat = false;     ///< its battery is
  bool joined = false;   ///< a member of its island; always, with `stack = "mac"`
  bool radio_on = false; ///< at this very moment
  double used_mah = 0;
  double battery_mah = 0; ///< infinite: it is fed by a cable
  mote_id parent = {};    ///< that it sends by, or the sink; 0: it has no route to the sink
  std::uint8_t hops = 0;
  std::optional<int> signal_dbm = {}; ///< of its parent's newest frame
  std::optional<double> etx = {}; ///< expected transmissions to its parent, as its estimator has it
  std::uint32_t queued = 0;       ///< packets that wait for the way to the sink
  std::uint64_t originated = 0;   ///< packets of its own that it has sent over the tree, this life
  std::uint64_t forwarded = 0;    ///< packets of others, likewise
  /// Of its programs' reliable messages that have ended, in this life: share that was acknowledged.
  std::optional<double> delivery = {};
  energy_sample energy;
  std::vector<neighbour_sample> neighbours; ///< ascending by id
};

/// What an island has lost so far. Messages in transit are a cause of the layer `messages`.
struct island_sample {
  island_id island;
  std::map<std::string, cause_counts> lost; ///< by layer: `radio`, `mac`, `network`, `channels`,
                                            ///< `messages`, `serial`
};

/// An open link of a peer.
struct peer_link_sample {
  peer_id to;               ///< any_peer: not known yet
  std::uint32_t queued = 0; ///< packages that wait to leave
};

/// A PEIS peer, also as a gateway, at one moment.
struct peer_sample {
  std::string name;
  bool runs = false;
  std::vector<peer_link_sample> links;
  std::optional<std::uint32_t> to_sink = {}; ///< packets that wait for a gateway's cable
};

struct run_sample {
  instant at;
  std::vector<island_sample> islands;   ///< ascending by id
  std::vector<mote_sample> motes;       ///< ascending by address
  std::vector<peer_sample> peers = {};  ///< ascending by name
  cause_counts peis_lost = {};          ///< packages of all peers
  std::vector<loss_report> places = {}; ///< as run_report::losses, in no order
};

/// A component has set or deleted a tuple, or asked another peer for that.
struct tuple_write {
  instant at;
  std::string peer;  ///< whose component it is
  std::string owner; ///< whose tuple it is; else its id, if nobody knows its name
  std::string key;
  std::string value; ///< text; octets in hexadecimal, after `0x`
  bool deleted = false;
};

/// Points of one curve: all of few, and of many every second, fourth, ... so that memory is
/// bounded.
class thinned_series {
public:
  struct point {
    instant at;
    double value = 0;
  };
  static constexpr std::size_t points_max = 256;

  void add(instant at, double value);

  /// In order of time, the newest included.
  [[nodiscard]] std::vector<point> points() const;
  [[nodiscard]] std::uint64_t count() const { return count_; } ///< of all that were added
  [[nodiscard]] double least() const { return least_; }        ///< of all, as the next
  [[nodiscard]] double most() const { return most_; }

private:
  std::vector<point> points_;
  std::optional<point> newest_; ///< if it is not among them
  std::uint64_t stride_ = 1;
  std::uint64_t count_ = 0;
  double least_ = 0;
  double most_ = 0;
};

/// What a drawing of a run needs of all that was to be seen.
class history {
public:
  static constexpr std::size_t samples_max = 200;
  static constexpr std::size_t tuples_max = 4096;

  void add(const run_sample& x);
  void add(const tuple_write& x);

  /// Charge used by each mote, at each of `times()`; before it was there 0.
  [[nodiscard]] const std::map<mote_address, std::vector<float>>& used_mah() const {
    return used_mah_;
  }
  [[nodiscard]] const std::vector<instant>& times() const { return times_; }

  /// What all islands have lost so far, at each of `times()`, by layer and cause.
  using layer_cause = std::pair<std::string, std::string>;
  [[nodiscard]] const std::map<layer_cause, std::vector<double>>& lost() const { return lost_; }
  [[nodiscard]] const std::optional<run_sample>& newest() const { return newest_; }

  /// Values that are numbers, `on` or `off`, by owner and key; of very many tuples the first.
  using tuple_key = std::pair<std::string, std::string>;
  [[nodiscard]] const std::map<tuple_key, thinned_series>& tuples() const { return tuples_; }

private:
  std::vector<instant> times_;
  std::map<mote_address, std::vector<float>> used_mah_;
  std::map<layer_cause, std::vector<double>> lost_;
  std::uint64_t stride_ = 1;
  std::uint64_t samples_ = 0;
  std::optional<run_sample> newest_;
  std::map<tuple_key, thinned_series> tuples_;
};

/// The number that a value begins with, `22.3 C`; `on` is 1 and `off` is 0; nothing of other texts.
[[nodiscard]] std::optional<double> number_of(std::string_view value);

} // namespace rubicon::report
