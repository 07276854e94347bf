// What the tests of all formats use.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "config/load.hpp"
#include "imports/plan.hpp"
#include "support/catch.hpp"

namespace shapes {

using namespace rubicon;
using namespace rubicon::imports;

/// What a run would say of the file that is written; empty: nothing.
inline std::string complaints_about(const imported& x, format from, std::string_view text) {
  const auto toml = toml_of(x, from, "the file", "topology.txt");
  const auto loaded =
      config::load_text(toml, "imported.toml", {}, [&](const std::string&, std::size_t) {
        return config::file_text{std::string(text), {}};
      });
  std::string out;
  for (const auto& each : loaded.problems)
    out += to_string(each) + '\n';
  return out;
}

/// A file that is taken, and of which an ecology is written that runs.
inline imported taken(format from, std::string_view text, std::string_view sink = {}) {
  auto x = import_text(from, text, sink);
  if (const auto* why = std::get_if<import_problem>(&x))
    FAIL(why->at.line << ':' << why->at.column << ": " << why->message);
  CHECK(complaints_about(std::get<imported>(x), from, text) == "");
  return std::get<imported>(std::move(x));
}

/// `LINE:COLUMN: why` of a file that is not taken; empty: it is.
inline std::string refused(format from, std::string_view text, std::string_view sink = {}) {
  const auto x = import_text(from, text, sink);
  const auto* why = std::get_if<import_problem>(&x);
  return why == nullptr ? std::string()
                        : std::to_string(why->at.line) + ':' + std::to_string(why->at.column) +
                              ": " + why->message;
}

/// Where the first note with these words is; line 0 and column 1 if there is none.
inline text_place noted(const imported& x, std::string_view words) {
  const auto found = std::ranges::find_if(
      x.notes, [&](const left_out& each) { return each.what.find(words) != std::string::npos; });
  return found == x.notes.end() ? text_place{0, 1} : found->at;
}

/// A text several times, each with its number, from `first` on, in the place of `#`.
inline std::string repeated(std::string_view text, std::size_t count, std::size_t first = 0) {
  std::string out;
  for (std::size_t i = first; i < first + count; ++i)
    for (const char c : text)
      if (c == '#')
        out += std::to_string(i);
      else
        out += c;
  return out;
}

} // namespace shapes
