// One life of a mote's firmware: when it is called, and what it may ask for (docs/firmware.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "firmware/code.hpp"

namespace rubicon::firmware {

inline constexpr std::size_t open_frames_max = 4;   ///< that `sent` was not called for
inline constexpr std::size_t lines_max = 16;        ///< of log and serial line, of one call
inline constexpr std::size_t line_octets_max = 200; ///< the rest of a line is cut off
/// From one call of `run` to the next, at least: a timer of the past must not stop time.
inline constexpr duration run_pause_min = 10us;

/// A frame for the radio, without its checksum.
struct send_frame {
  bytes octets;
};

struct switch_radio {
  bool on = true;
};

struct show_leds {
  unsigned on = 0;
};

/// A line that the firmware has logged, or that has ended on its serial line.
struct write_line {
  bool serial = false;
  std::string text; ///< printable characters of ASCII; others are `?`
};

using output = std::variant<send_frame, switch_radio, show_leds, write_line>;
using outputs = std::vector<output>;

struct session_counters {
  std::uint64_t calls = 0;          ///< of functions of the firmware
  std::uint64_t frames = 0;         ///< handed to the radio
  std::uint64_t unsent = 0;         ///< of these, those that did not arrive or never left it
  std::uint64_t frames_full = 0;    ///< refused: too many were open
  std::uint64_t frames_invalid = 0; ///< refused: too short or too long, or an acknowledgement
  std::uint64_t received = 0;
  std::uint64_t serial_octets = 0;
  std::uint64_t lines_dropped = 0;  ///< above the limit of one call
  std::uint64_t early_timers = 0;   ///< for the past, or so soon that they were postponed
  std::uint64_t absent_sensors = 0; ///< readings of sensors that the mote does not have
};
RUBICON_FIELDS(session_counters, calls, frames, unsent, frames_full, frames_invalid, received,
               serial_octets, lines_dropped, early_timers, absent_sensors);

/// Sans-I/O. Times are those of the mote's clock; the firmware's begin at start().
class session final : private host {
public:
  /// Reads a sensor by the name of its quantity, as a count; nothing: there is none.
  using reader = std::function<std::optional<std::int32_t>(std::string_view)>;

  /// @param firmware not nullptr
  session(std::unique_ptr<code> firmware, const identity& who, random_stream rng, reader read);
  session(const session&) = delete;
  session& operator=(const session&) = delete;
  ~session() override { code_.reset(); } ///< while what it may request at its end is still there

  // Each may throw what the firmware's code throws: it has failed, and is called no more.
  [[nodiscard]] outputs start(instant now);
  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  /// @param frame without its checksum
  [[nodiscard]] outputs on_frame(byte_view frame, int rssi_dbm, instant now);
  /// A frame has come to its end, in the order in which they were sent. @pre one is open
  [[nodiscard]] outputs on_sent(outcome how, instant now);

  [[nodiscard]] std::optional<instant> deadline() const { return due_; }
  [[nodiscard]] std::size_t open_frames() const { return open_; }
  [[nodiscard]] const session_counters& counters() const { return counters_; }

private:
  template <class Call>
  outputs call(instant now, Call what);

  answer send(byte_view frame) override;
  void set_radio(bool on) override;
  void set_timer(std::uint64_t at_us) override;
  void write_serial(byte_view octets) override;
  std::uint32_t draw() override;
  std::optional<std::int32_t> read(std::string_view sensor) override;
  void set_leds(unsigned on) override;
  void log(std::string_view line) override;

  template <class Output>
  void replace_last(Output x);
  [[nodiscard]] std::uint64_t shown(instant now) const;
  void put_line(bool serial, std::string text);
  void end_serial_line();

  std::unique_ptr<code> code_;
  identity who_;
  random_stream rng_;
  reader read_;
  instant began_;
  instant now_;
  std::optional<instant> due_;
  std::size_t open_ = 0;
  std::size_t lines_ = 0; ///< of this call
  std::string serial_;    ///< a line that has not ended
  outputs out_;
  session_counters counters_;
};

} // namespace rubicon::firmware
