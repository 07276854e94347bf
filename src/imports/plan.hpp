// What a file of another simulator or testbed says, in Rubicon's terms.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/time.hpp"

namespace rubicon::imports {

inline constexpr std::size_t file_octets_max = 64U << 20U;
inline constexpr std::size_t motes_max = 10'000;
inline constexpr std::uint32_t node_max = 65'000; ///< number of a mote
inline constexpr std::size_t links_max = 200'000;
inline constexpr std::size_t changes_max = 20'000;  ///< of links while the ecology runs
inline constexpr std::size_t waypoints_max = 1'000; ///< of one mote
inline constexpr double coordinate_max_m = 100'000;

/// From 1; line 0: the file as a whole.
struct text_place {
  std::size_t line = 0;
  std::size_t column = 0;

  friend bool operator==(text_place, text_place) = default;
};

/// Why a file cannot be imported.
struct import_problem {
  text_place at;
  std::string message;
};

/// Something in the file that the ecology lacks.
struct left_out {
  text_place at; ///< of the first of its kind
  std::string what;
};

struct point {
  double x_m = 0;
  double y_m = 0;
  double z_m = 0;

  friend bool operator==(point, point) = default;
};

struct planned_mote {
  std::uint32_t number = 0; ///< in the file; unique
  std::string name;         ///< in the file; empty: it has a number only
  point place;
  std::vector<std::pair<duration, point>> path; ///< ascending; a straight line between two of them
  std::string platform;                         ///< of Rubicon's; empty: the default
};

/// One direction between two motes, by their indices.
struct planned_link {
  std::size_t from = 0;
  std::size_t to = 0;
  std::optional<double> loss;
  std::optional<double> gain_db;
};

struct link_at {
  duration at{};
  std::size_t from = 0;
  std::size_t to = 0;
  double loss = 0;
};

/// All within range receive.
struct disk {
  double range_m = 50;
  double loss = 0;
};

/// Only planned links exist; each has a gain.
struct listed_links {};

/// Gains and noise come from the imported file itself, which is in TOSSIM's format.
struct topology_file {
  std::uint32_t first_node = 0; ///< the lowest that it names
  bool has_noise = false;
};

using planned_air = std::variant<disk, listed_links, topology_file>;

struct ecology_plan {
  std::string title; ///< as the file has it; may be empty
  std::optional<std::uint64_t> seed;
  duration length = 10min;
  planned_air air = disk{};
  std::vector<planned_mote> motes; ///< at least one; ascending by number
  std::vector<planned_link> links;
  std::vector<link_at> changes; ///< ascending by time
};

struct imported {
  ecology_plan plan;
  std::size_t sink = 0;        ///< index of the mote that is the sink
  std::vector<left_out> notes; ///< in the order of their places
};

using import_result = std::variant<imported, import_problem>;

enum class format : std::uint8_t { cooja, setdest, otns, iotlab, tossim, zep, k7 };

/// The words of `--format`.
[[nodiscard]] std::string_view to_string(format x);
[[nodiscard]] std::optional<format> parse_format(std::string_view word);

/// By the ending of its name and its first lines.
[[nodiscard]] std::optional<format> format_of(std::string_view file_name, std::string_view text);

/// @param text at most file_octets_max
/// @param sink the mote that is the sink: its name, or its number if it has none; empty: the first
/// one that does not move
[[nodiscard]] import_result import_text(format from, std::string_view text,
                                        std::string_view sink = {});

/// The plan as an ecology's file.
/// @param source name of the imported file, for the comment at its head
/// @param topology the same relative to the folder of the new file, where the plan refers to it
[[nodiscard]] std::string toml_of(const imported& x, format from, std::string_view source,
                                  std::string_view topology);

/// `FILE:3:7: not taken: scripts`, a line each.
[[nodiscard]] std::string notes_text(const imported& x, std::string_view source);

} // namespace rubicon::imports
