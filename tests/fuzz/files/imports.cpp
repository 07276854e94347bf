// Files of other simulators and testbeds: the first octet says which format the rest is in. Each
// gives an ecology that can be written, or a complaint with a place in the text.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>

#include "fuzz/require.hpp"
#include "imports/plan.hpp"

using namespace rubicon;
using namespace rubicon::imports;

namespace {

void check_place(text_place at, std::string_view text) {
  require(at.line <= 1 + static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')));
  require(at.column <= text.size() + 1);
}

void check_plan(const ecology_plan& x) {
  require(!x.motes.empty() && x.motes.size() <= motes_max);
  require(x.links.size() <= links_max && x.changes.size() <= changes_max);
  for (const auto& each : x.motes)
    require(each.path.size() <= waypoints_max);
  for (const auto& each : x.links)
    require(each.from < x.motes.size() && each.to < x.motes.size());
  for (const auto& each : x.changes)
    require(each.from < x.motes.size() && each.to < x.motes.size());
  require(std::ranges::is_sorted(x.changes, {}, &link_at::at));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return 0;
  constexpr auto formats = static_cast<unsigned>(format::k7) + 1;
  const auto from = static_cast<format>(data[0] % formats);
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto result = import_text(from, text);
  if (const auto* problem = std::get_if<import_problem>(&result)) {
    require(!problem->message.empty());
    check_place(problem->at, text);
    return 0;
  }
  const auto& found = std::get<imported>(result);
  check_plan(found.plan);
  for (const auto& each : found.notes)
    check_place(each.at, text);
  require(!toml_of(found, from, "file", "file").empty());
  static_cast<void>(notes_text(found, "file"));
  return 0;
}
