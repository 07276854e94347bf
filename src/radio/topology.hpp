// Who hears whom, how well, and how often a copy is lost on the way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/address.hpp"

namespace rubicon::radio {

struct radio_tag;

/// A radio of one channel: 0, 1, 2, ... in the order in which they were added.
using radio_index = strong_id<radio_tag, std::uint32_t>;

/// How a frame arrives.
struct signal {
  std::int8_t rssi_dbm = 0; ///< -100..0, whole dBm
  std::uint8_t lqi = 0;     ///< 50..110 (tinyos.md 4.1)

  friend bool operator==(const signal&, const signal&) = default;
};

/// A signal sent at 0 dBm after `distance_m`, by the log-distance law with 40 dB at the first metre
/// (free space at 2.4 GHz) and exponent 3 (indoors): -40 - 30 log10(d) dBm, rounded down; 1 m when
/// nearer. LQI falls by 3 for each dB below -75 dBm.
[[nodiscard]] signal signal_at(double distance_m);

/// A radio that hears another.
struct hearer {
  radio_index radio;
  float loss = 0; ///< chance that a copy is lost on the way to it
  signal heard;
};

/// Ascending by radio.
using hearers = std::vector<hearer>;

/// A unit disk: everybody within range hears, nobody else does (NET-15). Lists are made when a
/// radio is added or moved; who holds one keeps it as it was.
class topology {
public:
  topology() = default;
  topology(double range_m, double loss) : range_m_(range_m), loss_(loss) {}

  radio_index add(position place);
  void move(radio_index radio, position place);

  /// Replaces the general loss for one direction between two radios, near or not.
  void set_loss(radio_index from, radio_index to, double loss);

  /// Who hears `radio`; never nullptr.
  [[nodiscard]] std::shared_ptr<const hearers> around(radio_index radio) const {
    return around_[radio.value];
  }

  [[nodiscard]] std::size_t size() const { return places_.size(); }

private:
  void connect(radio_index radio);
  void insert(radio_index from, radio_index to, signal heard);
  hearers& editable(radio_index radio);
  [[nodiscard]] float loss_between(radio_index from, radio_index to) const;

  double range_m_ = 0;
  double loss_ = 0;
  std::vector<position> places_;
  std::vector<std::shared_ptr<hearers>> around_;
  std::map<std::pair<radio_index, radio_index>, double> losses_;
};

} // namespace rubicon::radio
