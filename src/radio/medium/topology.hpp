// Who receives whom, how strongly, and how often a copy is lost.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "radio/medium/grid.hpp"
#include "radio/medium/power.hpp"
#include "radio/medium/reception.hpp"
#include "radio/parameters.hpp"

namespace rubicon::radio {

struct radio_tag;

/// A radio of one channel: 0, 1, 2, ... in the order in which they were added.
using radio_index = strong_id<radio_tag, std::uint32_t>;

/// A directed link to a radio in reach. 16 octets: a mote among 100 others has 100 of them.
struct hearer {
  radio_index radio;
  float power = 0;          ///< received, in power_units; a whole number, 0 dBm at most
  float clean_damage = 0;   ///< error_model::damage at the receiver's constant noise alone
  std::uint16_t loss = 0;   ///< chance that a copy is lost besides, in 65535ths
  std::int8_t rssi_dbm = 0; ///< -100..0, whole dBm rounded down, as the chips report it
  std::uint8_t lqi = 0;     ///< 50..110, falls by 3 for each dB below -75 dBm (docs/tinyos.md 4.1)

  friend bool operator==(const hearer&, const hearer&) = default;
};

static_assert(sizeof(hearer) == 16);

/// Ascending by radio.
using hearers = std::vector<hearer>;

/// The link to a radio; nullptr: it is not in reach.
[[nodiscard]] inline const hearer* link_to(const hearers& all, radio_index radio) {
  const auto found = std::ranges::lower_bound(all, radio, {}, &hearer::radio);
  return found != all.end() && found->radio == radio ? &*found : nullptr;
}

/// Where and how a radio stands.
struct site {
  mote_address mote; ///< decides its random numbers; for gain_matrix its node
  position place;
  double transmit_dbm = 0;
  power_units own_noise = 0;              ///< of its receiver: noise counts with no less than this
  std::uint8_t channel = default_channel; ///< all_channels: whatever that of the other end is
};

/// A radio is in reach if its signal arrives with channel_config::cutoff_dbm or more; for a
/// unit_disk, if it is within range_m. Lists are made when a radio is added or moved, through a
/// grid of cells so that only radios near it are looked at; who holds a list keeps it as it was.
/// Between two channels there is no link at all, whatever the power.
///
/// Links do not depend on the order in which radios are added. link_overrides take precedence over
/// everything, range and cutoff included: a link with a gain exists (if its signal arrives with the
/// cutoff or more, for a unit_disk too), one with a loss keeps its other properties; of two for the
/// same link each property that the later one gives counts.
class topology {
public:
  topology() : topology(channel_config{}, 0) {}
  /// @param seed of the links' random numbers
  topology(const channel_config& config, std::uint64_t seed);

  /// Costs O(radios near it); for a gain_matrix O(its links). @pre the place is finite
  radio_index add(const site& x);

  /// Costs O(radios near its old and new place). No effect on a gain_matrix's links.
  void move(radio_index radio, position place);

  /// Replaces the loss for one direction between two radios, near or not; 0..1.
  void set_loss(radio_index from, radio_index to, double loss);

  /// As if the link had been among channel_config::links, after all others. Costs O(radios).
  void change(const link_override& x);

  /// Releases memory that lists have reserved for growing.
  void shrink();

  /// Who receives `radio`; never nullptr.
  [[nodiscard]] std::shared_ptr<const hearers> around(radio_index radio) const {
    return around_[radio.value];
  }

  /// The constant noise at a radio: 0 without noise, with a trace, and where a table gives none.
  [[nodiscard]] power_units noise(radio_index radio) const { return noise_[radio.value]; }

  [[nodiscard]] std::size_t size() const { return sites_.size(); }

private:
  using mote_pair = std::pair<mote_address, mote_address>; ///< from, to

  void use_table();
  void use_overrides();
  void note_gain(const link_override& x);

  void widen(double transmit_dbm);
  [[nodiscard]] std::vector<std::uint32_t> met(std::uint32_t radio) const;
  void meet_by_table(std::uint32_t radio, std::vector<std::uint32_t>& all) const;
  void renew(std::uint32_t radio, const std::vector<std::uint32_t>& others, bool is_new);

  [[nodiscard]] std::optional<double> path_db(const site& a, const site& b) const;
  [[nodiscard]] std::optional<double> arriving_dbm(const site& from, const site& to,
                                                   std::optional<double> path) const;
  [[nodiscard]] std::optional<double> by_law_dbm(const site& from, const site& to,
                                                 std::optional<double> path) const;
  [[nodiscard]] std::optional<hearer> link_between(std::uint32_t from, std::uint32_t to,
                                                   std::optional<double> path) const;
  [[nodiscard]] std::uint16_t loss_between(std::uint32_t from, std::uint32_t to) const;
  [[nodiscard]] power_units noise_at(const site& x) const;
  [[nodiscard]] std::optional<std::uint16_t> node_of(const site& x) const;

  void put(std::uint32_t from, std::uint32_t to, const std::optional<hearer>& link);
  hearers& editable(std::uint32_t radio);

  channel_config config_;
  std::uint64_t seed_ = 0;
  error_model errors_;

  std::vector<site> sites_;
  std::vector<power_units> noise_;
  std::vector<std::shared_ptr<hearers>> around_;

  grid grid_;
  double reach_m_ = 0; ///< beyond it no radio so far is received; the grid's edge at most

  std::vector<std::uint32_t> gains_by_target_; ///< indices into the table, by to, then from
  std::map<std::uint16_t, std::vector<std::uint32_t>> radios_of_node_;

  std::map<mote_pair, link_override> overrides_;
  std::map<mote_address, std::vector<mote_address>> given_gains_; ///< other ends, both directions
  std::map<mote_address, std::vector<std::uint32_t>> radios_of_mote_;
  std::map<std::pair<radio_index, radio_index>, std::uint16_t> losses_;
};

} // namespace rubicon::radio
