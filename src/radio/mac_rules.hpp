// How the transceivers and stacks of different motes get at the channel: numbers for radio/mac.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/time.hpp"
#include "radio/frame.hpp"
#include "radio/parameters.hpp"

namespace rubicon::radio {

/// The standard's numbers for 2.4 GHz (IEEE 802.15.4-2006 7.4).
namespace timing {
inline constexpr duration symbol = 16us;
inline constexpr duration octet = 2 * symbol;
inline constexpr duration unit_backoff = 20 * symbol;
inline constexpr duration cca = 8 * symbol; ///< what every transceiver here assesses
inline constexpr duration turnaround = 12 * symbol;
inline constexpr duration ack_wait = 54 * symbol; ///< from the end of the frame
inline constexpr duration sifs = 12 * symbol;
inline constexpr duration lifs = 40 * symbol;
inline constexpr std::size_t sifs_psdu_max = 18; ///< longer frames are followed by a LIFS
inline constexpr unsigned be_min = 3;            ///< macMinBE
inline constexpr unsigned be_max = 5;            ///< macMaxBE
inline constexpr unsigned backoffs_max = 4;      ///< macMaxCSMABackoffs
inline constexpr unsigned retries_max = 3;       ///< macMaxFrameRetries
} // namespace timing

/// A back-off is `first` plus 0 to count - 1 steps, all equally likely.
struct backoff_window {
  duration first;
  duration step;
  unsigned count;

  [[nodiscard]] constexpr duration longest() const {
    return first + step * static_cast<duration::rep>(count - 1);
  }
};

/// Between copies of a frame that is repeated until its receiver's radio is on: TinyOS's 10 to 49
/// ticks under low-power listening, in whole periods of the standard. Drawn anew each time, or two
/// who do not receive each other would go on colliding.
inline constexpr backoff_window copy_backoff{
    .first = timing::unit_backoff, .step = timing::unit_backoff, .count = 4};

/// As many as the standard can have in a round.
inline constexpr std::size_t windows_max = 6;

struct mac_rules {
  std::string_view name;
  /// After 0, 1, 2 and more busy assessments; the last also after further ones.
  std::array<backoff_window, windows_max> backoffs;
  unsigned assessments_max; ///< busy ones that end a round; 0: any number of them may be busy
  unsigned rounds_max;      ///< rounds that end so before the request fails
  duration assessment;      ///< from the end of the back-off to the end of the assessment
  duration second_look;     ///< from a clear assessment to another one; 0: there is no other
  duration turnaround;      ///< from the last assessment to the first octet
  duration ack_delay;       ///< from the end of a frame to the first octet of its ack
  duration ack_wait;        ///< from the end of the frame to the end of the ack, at most
  duration guard;           ///< the channel counts as busy so long after a frame that wants an ack
  bool spaces;              ///< SIFS and LIFS between frames
  bool dsn_from_address;    ///< DSNs begin at 16 times the address instead of anywhere
  bool weak_source_key;     ///< duplicates: sources are distinguished by the sum of their octets
  std::size_t sources_max;  ///< duplicates: sources remembered; 0: all
  unsigned retries_max;     ///< unless the file says otherwise

  /// From the end of a copy of a frame to the begin of the next one, where frames are repeated
  /// until their receiver's radio is on, and the channel is clear.
  [[nodiscard]] duration longest_gap() const;

  /// How long a sender may go on repeating a frame; never, if assessments are not limited.
  [[nodiscard]] duration repeats_for(unsigned retries) const;
};

/// The rules with a radio's own parameters. The three of back-offs have no effect on rules other
/// than the standard's. @pre macMinBE is not above macMaxBE
[[nodiscard]] mac_rules adjusted(const mac_rules& rules, const access_parameters& own);

/// Whether back-offs follow the standard: macMinBE, macMaxBE and macMaxCSMABackoffs mean something.
[[nodiscard]] bool has_exponents(const mac_rules& rules);

/// The rules of that name (mac_names()) on that platform, whose clock may make them slower.
/// @returns nullptr if there is no such name; else valid for ever
[[nodiscard]] const mac_rules* find_mac(std::string_view name, const platform& kind);

/// Those that `config` chooses for the platform: the standard's unless it names others.
/// @returns nullptr if it names unknown ones; else valid for ever
[[nodiscard]] const mac_rules* mac_of(const channel_config& config, const platform& kind);

} // namespace rubicon::radio
