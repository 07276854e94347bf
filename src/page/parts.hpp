// For files of this room only: the sections of a page, each empty if there is nothing to show.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "page/run_page.hpp"

namespace rubicon::page {

[[nodiscard]] std::string head_of(const run_page& x);
/// The earliest violation, with the newest fault and the events before it.
[[nodiscard]] std::string first_problem_of(const run_page& x);
[[nodiscard]] std::string map_of(const run_page& x);
/// Flows between more than this many motes are cells of a matrix, not lines on a map.
inline constexpr std::size_t lines_motes_max = 30;
[[nodiscard]] bool has_matrix(const run_page& x);
[[nodiscard]] std::string matrix_of(const run_page& x);
[[nodiscard]] std::string time_line_of(const run_page& x);
[[nodiscard]] std::string energy_of(const run_page& x);
[[nodiscard]] std::string tuples_of(const run_page& x);
[[nodiscard]] std::string losses_of(const run_page& x);
/// A chart of what a layer of samples has lost.
[[nodiscard]] std::string losses_over_time(const run_page& x, std::string_view layer);
[[nodiscard]] std::string motes_of(const run_page& x);
[[nodiscard]] std::string expectations_of(const run_page& x);
[[nodiscard]] std::string violations_of(const run_page& x);
/// Secure groups of motes.
[[nodiscard]] std::string groups_of(const run_page& x);
[[nodiscard]] std::string proxies_of(const run_page& x);
[[nodiscard]] std::string peers_of(const run_page& x);

/// The document around sections: title, style, and that nothing may be loaded or run.
[[nodiscard]] std::string document(std::string_view title, std::string_view sections);

/// A section under its heading; empty if `content` is.
[[nodiscard]] std::string section(std::string_view id, std::string_view title,
                                  std::string_view content);

/// What is drawn wider than a telephone is moved sideways there.
[[nodiscard]] std::string wide(std::string_view content);

/// A cell of a table; numbers stand to the right.
struct cell {
  std::string text;
  bool is_number = false;
  std::string_view look = {}; ///< class
};

[[nodiscard]] std::string head_row(const std::vector<cell>& cells);
[[nodiscard]] std::string row(const std::vector<cell>& cells);

/// How well something delivers, as a class: `good`, `fair`, `poor`, `bad`; `unknown` of nothing.
[[nodiscard]] std::string_view class_of(std::optional<double> delivery);

/// `fan (Küche)`: a name and its label, if it has one.
[[nodiscard]] inline std::string named(const run_page& x, config::label_table::kind what,
                                       const std::string& name) {
  return x.ecology.labels.with_name(what, name);
}

/// The same for who is named by an event or a tuple: `flat/hall (Flur) and 2 others`,
/// `flat.hall.temperature (Flur)`; of a mote its own label, or else that of its island.
[[nodiscard]] std::string labelled(const run_page& x, const std::string& name);

/// `97.3%`; `–` of nothing.
[[nodiscard]] std::string share(std::optional<double> x);

} // namespace rubicon::page
