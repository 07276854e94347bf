// What a file may say about the air and about the radios in it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::radio {

struct gain_table; // radio/medium/tossim_files.hpp
class noise_trace; // radio/medium/noise.hpp

// ------------------------------------------------------------------------------------- propagation

/// All within range receive, no other does (NET-15). The received power is that of
/// log_distance with its defaults, but decides nothing unless noise or collisions by SINR are asked
/// for.
struct unit_disk {
  double range_m = 30;
};

/// received = sent - reference_db - 10 exponent log10(d / 1 m) + X; nearer than 1 m counts as 1 m.
/// X is drawn for each pair of radios and for each direction of it, normal with these deviations
/// and cut off at three of them; it depends on the seed and the two addresses alone.
struct log_distance {
  double exponent = 3;
  double reference_db = 40; ///< loss at the first metre
  double shadowing_db = 0;  ///< standard deviation of what both directions share
  double asymmetry_db = 0;  ///< standard deviation of what each direction has for itself
};

/// Free space: loss = 20 log10(4 pi d f / c), 0 dB at most.
struct friis {
  double frequency_mhz = 2480; ///< TinyOS's default channel, 26
};

/// The gain of each directed link; without an entry there is no link at all.
struct gain_matrix {
  std::shared_ptr<const gain_table> table; ///< never nullptr in a valid description
  std::uint16_t first_mote = 1;            ///< node 0 of the table is the mote with this id
};

using propagation = std::variant<unit_disk, log_distance, friis, gain_matrix>;

// ------------------------------------------------------------------------------------------- noise

/// Nothing disturbs but other frames.
struct no_noise {};

struct constant_noise {
  double floor_dbm = -98; ///< the commonest reading of TOSSIM's traces
};

/// Each radio has the floor that the gain table gives its node.
struct table_noise {};

/// Readings of a real radio, one a millisecond, continued by closest-pattern matching.
struct traced_noise {
  std::shared_ptr<const noise_trace> trace; ///< never nullptr in a valid description
};

using noise_model = std::variant<no_noise, constant_noise, table_noise, traced_noise>;

// --------------------------------------------------------------------------------------- reception

enum class error_curve : std::uint8_t {
  oqpsk,  ///< bit error rate of IEEE 802.15.4-2006 E.4.1.8
  tossim, ///< docs/tinyos.md 6: chance for a whole frame, whatever its length
};

enum class collision_rule : std::uint8_t {
  sinr,   ///< interference raises the bit error rate while it lasts
  strict, ///< any overlap at a receiver loses both frames there
};

/// What becomes of a frame that arrives at about the receiver's sensitivity.
enum class sensitivity_edge : std::uint8_t {
  sharp, ///< below it nothing is received, above it noise alone decides
  noise, ///< the receiver's own noise decides: reception.hpp, sinr_at_sensitivity()
};

/// What makes a clear-channel assessment find the channel busy.
enum class sensing : std::uint8_t {
  energy,            ///< CCA mode 1: power at or above the threshold
  carrier,           ///< CCA mode 2: a frame is being received
  energy_or_carrier, ///< either
};

/// When it must be so.
enum class sensing_window : std::uint8_t {
  whole, ///< at any moment of the 128 us
  end,   ///< at their last moment
};

/// The transmission from one mote to another is lost with this chance instead of
/// channel_config::loss; or arrives with this gain, whatever the propagation says.
struct link_override {
  mote_address from;
  mote_address to;
  std::optional<double> loss{};    ///< 0..1
  std::optional<double> gain_db{}; ///< received dBm at 0 dBm sent
};

/// The medium: how strongly frames arrive, what disturbs them, and what receivers make of it.
struct channel_config {
  radio::propagation propagation{};
  noise_model noise{};
  /// What arrives more weakly is not even interference; not for unit_disk.
  double cutoff_dbm = -115;
  std::optional<double> sensitivity_dbm{}; ///< unset: the platform's; not for unit_disk
  sensitivity_edge edge = sensitivity_edge::sharp;
  std::optional<double> cca_dbm{}; ///< energy threshold; unset: the platform's
  error_curve curve = error_curve::oqpsk;
  collision_rule collisions = collision_rule::strict;
  /// A receiver leaves the frame it is receiving for a much stronger later one.
  bool capture = false;
  radio::sensing sensing = radio::sensing::energy_or_carrier;
  sensing_window window = sensing_window::whole;
  double loss = 0;       ///< chance that one copy of a frame is lost besides, per receiver, 0..1
  std::size_t queue = 8; ///< frames a radio's transmit queue holds; more are refused and counted
  std::optional<unsigned> retries_max{}; ///< repeats without an ack; unset: the MAC's own number
  std::optional<std::size_t> receive_slots{}; ///< unset: the platform's
  std::optional<duration> service_time{};     ///< unset: the platform's
  /// By platform name; a platform that is absent here has the standard's.
  std::vector<std::pair<std::string, std::string>> macs{};
  std::vector<link_override> links{};
};

// --------------------------------------------------------------------------------------- platforms

/// Transmit current at a power setting.
struct transmit_level {
  double dbm;
  double current_ma;
};

/// Currents and limits of a kind of mote (docs/tinyos.md 7.1, 7.3).
struct platform {
  std::string_view name;
  double mcu_active_ma;
  double mcu_sleep_ma;
  double radio_off_ma;
  double radio_listen_ma;                 ///< also while receiving (docs/tinyos.md 7.1)
  std::array<transmit_level, 8> transmit; ///< ascending by dBm; a shorter table repeats its first
  double supply_v;
  double battery_mah;        ///< two AA cells (docs/tinyos.md 7.2)
  double sensitivity_dbm;    ///< what arrives more weakly is not received
  double cca_dbm;            ///< energy threshold of clear-channel assessment
  std::uint32_t serial_baud; ///< docs/tinyos.md 1.1
  std::size_t receive_slots; ///< frames it can hold while the MCU is busy
  duration service_time;     ///< how long the MCU needs per frame, received or sent [estimate]

  /// Full power, the default.
  [[nodiscard]] double transmit_dbm_max() const { return transmit.back().dbm; }

  /// Current while sending at `dbm`: linear between two settings of the table, its ends beyond.
  [[nodiscard]] double transmit_ma(double dbm) const;
};

/// What one radio's medium access may have of its own; unset: what its rules have
/// (radio/mac_rules.hpp). Names and ranges of IEEE 802.15.4-2006 table 86; the first three belong
/// to the standard's rules.
struct access_parameters {
  std::optional<unsigned> min_be{};       ///< macMinBE, 0..macMaxBE
  std::optional<unsigned> max_be{};       ///< macMaxBE, 3..8
  std::optional<unsigned> backoffs_max{}; ///< macMaxCSMABackoffs, 0..5
  std::optional<unsigned> retries_max{};  ///< macMaxFrameRetries, 0..7

  [[nodiscard]] bool is_set() const { return min_be || max_be || backoffs_max || retries_max; }
};

/// Low-power listening: BoX-MAC-2 as TinyOS has it (Moss and Levis, BoX-MACs, SING-08-00; TEP 105).
/// A radio is on only to see whether anything is on the air, and while there is. Who sends repeats
/// a frame until its receiver has been on.
struct listening_config {
  duration interval{};    ///< from one check to the next; 0: the radio is always on
  duration check = 11ms;  ///< how long one takes: 400 samples of a CC2420, started up before
  duration awake = 100ms; ///< after a busy check, or a frame received or sent (DELAY_AFTER_RECEIVE)
  /// A frame is repeated for so much longer than the interval.
  static constexpr duration margin = 20ms;
  bool checks = true; ///< else its radio is always on, but it sends to those that are not

  [[nodiscard]] bool enabled() const { return interval > 0s; }

  /// A mote is not gone before it has been silent for so long: it says that it is there in a fifth
  /// of this time, which takes half an interval at each hop.
  [[nodiscard]] duration silence_min() const { return 60 * interval; }

  /// For how long a frame is repeated, at most: each neighbour has checked by then.
  [[nodiscard]] duration train() const { return enabled() ? interval + margin : duration{}; }
};

/// Channels of IEEE 802.15.4 at 2.4 GHz: k is at 2405 + 5 (k - 11) MHz (docs/tinyos.md 4.1).
inline constexpr std::uint8_t channel_min = 11;
inline constexpr std::uint8_t channel_max = 26;
inline constexpr std::uint8_t default_channel = 26; ///< TinyOS's
inline constexpr std::uint8_t all_channels = 0;     ///< of what disturbs them all

/// MicaZ, IRIS and TelosB.
[[nodiscard]] const std::array<platform, 3>& platforms();

/// @returns nullptr if there is no such platform
[[nodiscard]] const platform* find_platform(std::string_view name);

/// Names of the medium access rules of radio/mac_rules.hpp: standard, cc2420, rf230.
[[nodiscard]] const std::vector<std::string>& mac_names();

} // namespace rubicon::radio
