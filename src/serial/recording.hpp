// What has passed a serial line, as text: recorded and played again (ACT-08).
//
//   # rubicon serial recording 1
//   12.004160 kitchen up 45 00ffff0001...
//
// A line for each frame with a good CRC: the time of the run in seconds, the island, `up` to the PC
// or `down` to the mote, type, sequence number if it has one, and packet.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "serial/cable/line.hpp"
#include "serial/frame.hpp"

namespace rubicon::serial {

inline constexpr std::string_view recording_title = "# rubicon serial recording 1";

/// Behind the name of an island stands that of its line to real motes.
inline constexpr std::string_view real_line_suffix = "/real";

/// Of a file that is read.
inline constexpr std::size_t recording_octets_max = std::size_t{256} << 20;

struct recorded_frame {
  instant at;
  std::string island;
  direction towards = direction::to_pc;
  frame what;

  friend bool operator==(const recorded_frame&, const recorded_frame&) = default;
};

/// Its line, without a line feed.
[[nodiscard]] std::string to_text(const recorded_frame& x);

struct recording_problem {
  std::size_t line = 0;
  std::string message;
};

/// A line; nothing if it is empty or a comment. A problem has no line number.
[[nodiscard]] std::variant<std::monostate, recorded_frame, recording_problem>
read_recorded(std::string_view line);

/// All that the island's sink has said, in order of time; empty if the recording has nothing of it.
[[nodiscard]] std::variant<std::vector<recorded_frame>, recording_problem>
read_recording(std::string_view text, std::string_view island);

/// A recording in a cable's place. What the PC's end sends is acked, and goes nowhere.
class replay {
public:
  replay() = default;

  /// @param all ascending by time; not nullptr
  /// @param speed how often the recorded time passes in one, > 0
  replay(std::shared_ptr<const std::vector<recorded_frame>> all, double speed);

  /// What has come by now: octets for the PC's end.
  [[nodiscard]] bytes on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Frames of the PC's end. @returns octets for it
  [[nodiscard]] bytes on_pc(byte_view octets);

private:
  [[nodiscard]] instant due(const recorded_frame& x) const;

  std::shared_ptr<const std::vector<recorded_frame>> all_;
  double speed_ = 1;
  std::size_t next_ = 0;
  frame_decoder decoder_;
};

} // namespace rubicon::serial
