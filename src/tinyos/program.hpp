// Plain programs of TinyOS on a mote: what Oscilloscope, BlinkToRadio and RadioCountToLeds send,
// and what they make of each other's packets (tinyos.md 3; the layouts are the programs' own).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "tinyos/program_config.hpp"

namespace rubicon::tinyos {

inline constexpr std::uint8_t oscilloscope_type = 0x93;
inline constexpr std::uint8_t counter_type = 6; ///< of both BlinkToRadio and RadioCountToLeds
inline constexpr std::size_t readings_in_packet = 10;

/// For everybody in reach, without an acknowledgement.
struct packet {
  std::uint8_t am_type = 0;
  bytes payload;

  friend bool operator==(const packet&, const packet&) = default;
};

struct program_counters {
  std::uint64_t packets = 0;    ///< handed to the radio
  std::uint64_t unsent = 0;     ///< of these, those that never left it
  std::uint64_t radio_busy = 0; ///< packets left out: the one before was still at the radio
  std::uint64_t received = 0;   ///< packets of its own layout
  std::uint64_t ignored = 0;    ///< packets of its AM type and another layout
  std::uint64_t settings = 0;   ///< received ones whose version was higher: their interval is its
};
RUBICON_FIELDS(program_counters, packets, unsent, radio_busy, received, ignored, settings);

/// Sans-I/O. One packet is at the radio at a time; what falls due meanwhile is left out.
///
/// An oscilloscope has a version, an interval and a count of packets. From a packet with a higher
/// version it takes version and interval and begins its readings anew; of one with a higher count
/// it takes the count, so that packets of several motes show which readings are of one time.
///
/// Deviation: milliseconds have 1000 to the second, TinyOS's 1024.
class program {
public:
  /// Reads its transducer, as a count of 16 bits.
  using reader = std::function<std::uint16_t()>;

  program() = default;
  /// @param first when its timer fires for the first time: motes are not switched on all at once
  program(const program_config& config, mote_id self, instant first);

  /// @returns what is to be sent, if anything. Harmless before deadline()
  [[nodiscard]] std::optional<packet> on_time(instant now, const reader& read);

  /// The radio has delivered a packet.
  void on_packet(std::uint8_t am_type, byte_view payload, instant now);

  /// The packet has ended. @param sent it has left the radio
  void on_sent(bool sent);

  [[nodiscard]] instant deadline() const { return due_; }

  [[nodiscard]] std::uint8_t leds() const { return leds_; } ///< one bit each, as it shows them
  [[nodiscard]] duration interval() const { return interval_; }
  [[nodiscard]] std::uint16_t version() const { return version_; }
  [[nodiscard]] const program_counters& counters() const { return counters_; }

private:
  [[nodiscard]] std::optional<packet> read_on(instant now, const reader& read);
  [[nodiscard]] std::optional<packet> send(packet x);
  [[nodiscard]] packet readings() const;
  [[nodiscard]] packet count() const;
  void on_settings(byte_view payload, instant now);

  program_kind kind_ = program_kind::count;
  mote_id self_;
  duration interval_{};
  instant due_;
  bool at_radio_ = false;
  std::uint8_t leds_ = 0;
  std::uint16_t version_ = 0;
  std::uint16_t count_ = 0;
  bool took_count_ = false; ///< of another mote: the next packet does not add to it
  std::array<std::uint16_t, readings_in_packet> readings_{};
  std::size_t filled_ = 0;
  program_counters counters_;
};

} // namespace rubicon::tinyos
