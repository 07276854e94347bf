// Warnings about a file that is valid but cannot work: tuples that are read and that no component
// has, words that no input accepts, fields that no program sends, motes that no radio receives.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "config/load.hpp"
#include "config/plan/ecology.hpp"
#include "config/plan/places.hpp"

namespace rubicon::config {

/// One sentence, and its place; line 0: about the file as a whole.
using warning = std::pair<mark, std::string>;
using warning_list = std::vector<warning>;

inline constexpr std::size_t warnings_max = 50;

/// All of a file that was loaded, in order of place, with those that its readers had; at most
/// `warnings_max`. @pre it has no problems
[[nodiscard]] std::vector<problem> warnings_of(const loaded& x, const std::string& file_name);

/// Whether peers and programs may be there of which the file says nothing.
[[nodiscard]] bool strangers_may_come(const ecology_description& all);

/// Of proxies: their classes, fields and inputs, and the motes that have none.
void warn_of_proxies(const ecology_description& x, const file_places& seen, warning_list& out);

/// Of tuples that the file names: whether a component has them, publishes such words and numbers,
/// and accepts what is written. A tuple that no component has is no warning where peers of other
/// processes may connect: their tuples are not known.
void warn_of_tuples(const ecology_description& x, const file_places& seen, warning_list& out);

/// Of messages between motes: whether a program at their receiver takes them.
void warn_of_messages(const ecology_description& x, const file_places& seen, warning_list& out);

/// Of streams between programs: whether each has a read end, and one write end.
void warn_of_streams(const ecology_description& x, const file_places& seen, warning_list& out);

/// Of motes whose frames no sink can receive, and of those that walk too fast for their `step`.
void warn_of_radios(const ecology_description& x, const file_places& seen, warning_list& out);

/// Of traces with no reading, or next to none, within the run.
void warn_of_traces(const ecology_description& x, const file_places& seen, warning_list& out);

} // namespace rubicon::config
