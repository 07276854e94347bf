// What is no mistake in a file, and yet cannot work: readers of tuples that nobody has, words that
// nobody takes, fields that no program sends, motes that nobody hears.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "config/load.hpp"
#include "config/plan/ecology.hpp"
#include "config/plan/places.hpp"

namespace rubicon::config {

/// One sentence, and its place; line 0: of the file as a whole.
using doubt = std::pair<mark, std::string>;
using doubt_list = std::vector<doubt>;

inline constexpr std::size_t doubts_max = 50;

/// All of a file that was loaded, in order of place, with those that its readers had; at most
/// `doubts_max`. @pre it has no problems
[[nodiscard]] std::vector<problem> doubts_of(const loaded& x, const std::string& file_name);

/// Of proxies: their classes, fields and inputs, and the motes that have none.
void doubt_proxies(const ecology_description& x, const file_places& seen, doubt_list& out);

/// Of tuples that the file names: whether somebody has them, tells such words and numbers, and
/// takes what is written. That nobody has a tuple is not said when peers of other processes may
/// come, which have whatever they have.
void doubt_tuples(const ecology_description& x, const file_places& seen, doubt_list& out);

/// Of messages between motes: whether a program at their receiver takes them.
void doubt_messages(const ecology_description& x, const file_places& seen, doubt_list& out);

/// Of motes that no sink can hear, and of those that walk too fast for their `step`.
void doubt_radios(const ecology_description& x, const file_places& seen, doubt_list& out);

/// Of traces with no reading, or next to none, within the run.
void doubt_traces(const ecology_description& x, const file_places& seen, doubt_list& out);

} // namespace rubicon::config
