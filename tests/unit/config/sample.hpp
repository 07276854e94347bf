// Small files for the tests of the config room.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/load.hpp"

namespace rubicon::test {

/// What ends in line 5, is good by itself, and says nothing about islands: an [ecology] and a peer.
inline constexpr std::string_view head = "[ecology]\nname = \"t\"\n"
                                         "[[peer]]\nname = \"pc\"\nid = 300\n";

/// The same up to line 14, with one island `k` of the id 1, a sink at the origin, and a mote type
/// `c`, number 7, with a temperature and a fan. What follows may begin with island.mote tables.
inline constexpr std::string_view island_head =
    "[ecology]\nname = \"t\"\nduration = \"1h\"\n"
    "[[peer]]\nname = \"pc\"\nid = 300\n"
    "[mote_type.c]\ntype = 7\n"
    "transducers.temperature = { model = \"constant\", value = 20 }\n"
    "actuators = [{ name = \"fan\", kind = \"relay\" }]\n"
    "[[island]]\nname = \"k\"\nid = 1\n"
    "\n";

/// island_head and a mote of type `c` with the id 2: what follows, from line 19, is about the mote.
inline const std::string mote_head =
    std::string(island_head) + "[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n";

/// head and a proxy of type 7; what follows stands from line 9.
inline const std::string proxy_head = std::string(head) + "[[proxy]]\nname = \"p\"\ntypes = [7]\n";

/// proxy_head and one of its fields or inputs; what follows stands from line 12.
inline const std::string field_head = proxy_head + "[[proxy.field]]\nname = \"f\"\nchannel = 1\n";
inline const std::string input_head = proxy_head + "[[proxy.input]]\nname = \"i\"\nchannel = 2\n";

/// A piece of a file and what is wrong with it.
struct row {
  const char* toml;
  const char* problem; ///< all problems, a line each; `none` without any
};

/// Every problem as `line:column: message`.
[[nodiscard]] std::vector<std::string> problems_in(const std::string& toml);

/// All problems with their files, a line each; `none` without any.
[[nodiscard]] std::string problems_of(const config::loaded& x);

/// What reading a file gives if there are only these.
[[nodiscard]] config::file_text text_in(const std::map<std::string, std::string>& files,
                                        const std::string& path);

/// The only problem; `none` without any, all of them in one text if there are several.
[[nodiscard]] std::string problem_in(const std::string& toml);
[[nodiscard]] std::string problem_after(std::string_view start, std::string_view rest);

/// Reads each of some pieces of files, which blank lines separate, behind `start`, and checks all
/// that is wrong with it. Comments in the piece tell what must be, each below the line of the
/// mistake:
///
///   queue = 0
///   #       ^ `queue` must be a whole number from 1 to 1024, not 0
///   [radios]
///   #^ unknown key `radios` in the file: did you mean `radio`?
///
/// The caret is below the place; `#<` stands for the first column, and `#@ LINE:COLUMN: ...` tells
/// a mistake outside of the piece. Comments that begin with `#   ` and have no caret go on with the
/// message before.
void check_mistakes(std::string_view start, std::string_view pieces);

/// @pre there are no problems: throws std::runtime_error that tells them
[[nodiscard]] config::ecology_description good(const std::string& toml);

} // namespace rubicon::test
