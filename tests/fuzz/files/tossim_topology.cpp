// Whatever the text, reading it ends with a table in order or with one plain, placed message; a
// table written out is read as the same again.
#include <algorithm>
#include <cassert>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "file_problem.hpp"
#include "radio/medium/tossim_files.hpp"

using namespace rubicon::radio;

namespace {

std::string text(float x) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, x).ptr};
}

std::string written(const gain_table& table) {
  std::string all;
  for (const auto& x : table.gains)
    all += "gain " + std::to_string(x.from) + ' ' + std::to_string(x.to) + ' ' + text(x.db) + '\n';
  for (const auto& x : table.floors)
    all += "noise " + std::to_string(x.node) + ' ' + text(x.dbm) + " 0\n";
  return all;
}

void check_table(const gain_table& table) {
  assert(!table.gains.empty());
  const gain_table::gain* last = nullptr;
  for (const auto& x : table.gains) {
    assert(x.from != x.to && x.from <= 65534 && x.to <= 65534 && x.db >= -250 && x.db <= 50);
    assert(!last || last->from < x.from || (last->from == x.from && last->to < x.to));
    last = &x;
  }
  for (std::size_t i = 1; i < table.floors.size(); ++i)
    assert(table.floors[i - 1].node < table.floors[i].node);
  const auto again = read_topology(written(table));
  assert(std::get<gain_table>(again) == table);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const auto x = read_topology(input);
  if (const auto* problem = std::get_if<file_problem>(&x)) {
    check_problem(*problem, input);
  } else {
    check_table(std::get<gain_table>(x));
  }
  return 0;
}
