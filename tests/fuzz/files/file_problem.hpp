// What every complaint about a file must be like.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <string_view>

#include "radio/medium/tossim_files.hpp"

/// Placed inside the text, short, and in plain ASCII.
inline void check_problem(const rubicon::radio::file_problem& problem, std::string_view input) {
  assert(problem.line <=
         1 + static_cast<std::size_t>(std::count(input.begin(), input.end(), '\n')));
  assert(!problem.message.empty() && problem.message.size() < 240);
  assert(std::all_of(problem.message.begin(), problem.message.end(),
                     [](char c) { return c >= ' ' && c <= '~'; }));
}
