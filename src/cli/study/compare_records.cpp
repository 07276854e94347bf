#include "cli/study/compare_records.hpp"

#include <cstddef>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "core/time.hpp"
#include "explain/record.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

using nlohmann::json;

constexpr std::size_t value_width_max = 60;

/// One record, line by line.
struct lines {
  std::istream& in;
  const std::string& name;
  std::string header;
  std::string line;
  std::uint64_t number = 0;

  bool next() {
    line.clear();
    const bool found = static_cast<bool>(std::getline(in, line));
    number += found ? 1 : 0;
    return found;
  }
};

/// The header and the line that it has come to; or what is wrong with them.
std::variant<explain::recording, std::string> decoded(const lines& x) {
  explain::decoder decoder;
  auto wrong = decoder.take(x.header);
  if (!wrong && x.number > 1 && !x.line.empty())
    wrong = decoder.take(x.line);
  if (wrong)
    return x.name + ':' + std::to_string(x.number) + ": " + wrong->message;
  return std::move(decoder.result());
}

/// Why something is no record.
struct bad_record {
  std::string why;
};

std::string begin_of(const lines& x, char letter, const explain::header& head) {
  return std::string(1, letter) + ": " + printable(x.name) + ", " + printable(head.ecology) +
         ", seed " + std::to_string(head.seed) + ", file " + printable(head.digest) + '\n';
}

std::string event_of(const explain::record& x) {
  auto text = to_text(x.time) + ' ' + std::string(to_string(x.what));
  if (!x.from.empty() || !x.to.empty())
    text += ' ' + printable(x.from) + (x.to.empty() ? "" : " -> " + printable(x.to));
  return text + (x.number == 0 ? "" : " (" + std::to_string(x.number) + ')');
}

std::string value_of(const json& x, const std::string& key) {
  return x.contains(key) ? report::cut(printable(json_line(x.at(key))), value_width_max) : "-";
}

/// `number: 12 / 13`, a line for each field in which both differ.
std::string fields_of(const std::string& a, const std::string& b) {
  const auto x = try_parse_json(a);
  const auto y = try_parse_json(b);
  if (!x.is_object() || !y.is_object())
    return {};
  auto merged = x;
  merged.update(y);
  std::string text;
  for (const auto& [key, unused] : merged.items())
    if (!x.contains(key) || !y.contains(key) || x.at(key) != y.at(key))
      text += "  " + printable(key) + ": " + value_of(x, key) + " / " + value_of(y, key) + '\n';
  return text;
}

std::string side_of(char letter, bool has_line, const explain::recording& x) {
  return std::string(1, letter) + ": " +
         (has_line && !x.records.empty() ? event_of(x.records.back()) : "ends") + '\n';
}

/// What counts what happened before, recorded or not.
json without_numbers(const std::string& line) {
  auto x = try_parse_json(line);
  if (x.is_object())
    for (const auto* each : {"number", "cause", "id"})
      x.erase(each);
  return x;
}

bool differ_in_numbers(const lines& a, const lines& b) {
  return a.line == b.line || without_numbers(a.line) == without_numbers(b.line);
}

/// Which of both have a line.
using both = std::pair<bool, bool>;

/// Reads on while both are equal. @returns which of both have a line then
template <class Equal>
both skip_equal(lines& a, lines& b, std::uint64_t& skipped, Equal are_equal) {
  for (;; ++skipped) {
    const bool in_a = a.next();
    const bool in_b = b.next();
    if (!in_a || !in_b || !are_equal(a, b))
      return {in_a, in_b};
  }
}

/// Both lines, and in what they differ; or what is wrong with them.
std::variant<std::string, bad_record> lines_of_both(const lines& a, const lines& b, both has_line) {
  const auto in_a = decoded(a);
  const auto in_b = decoded(b);
  for (const auto* const each : {&in_a, &in_b})
    if (const auto* why = std::get_if<std::string>(each))
      return bad_record{*why};
  return side_of('A', has_line.first, std::get<explain::recording>(in_a)) +
         side_of('B', has_line.second, std::get<explain::recording>(in_b)) +
         (has_line.first && has_line.second ? fields_of(a.line, b.line) : std::string());
}

/// What follows where only numbers differ, up to the first that differs in more.
std::variant<std::string, bad_record> beyond_numbers(lines& a, lines& b) {
  std::uint64_t skipped = 1;
  const auto has_line = skip_equal(a, b, skipped, differ_in_numbers);
  if (!has_line.first && !has_line.second)
    return std::string("Up to the end only numbers differ.\n");
  auto found = lines_of_both(a, b, has_line);
  if (auto* text = std::get_if<std::string>(&found))
    *text = "Only numbers differ in " + report::counted(skipped, "record") +
            ": one has done something before that is not recorded. Then:\n" + *text;
  return found;
}

} // namespace

record_difference compare_records(std::istream& a, const std::string& a_name, std::istream& b,
                                  const std::string& b_name) {
  lines x{a, a_name, {}, {}};
  lines y{b, b_name, {}, {}};
  record_difference out;
  std::vector<std::uint64_t> seeds;
  for (auto* const each : {&x, &y}) {
    static_cast<void>(each->next());
    each->header = each->line;
    const auto found = decoded(*each);
    if (const auto* why = std::get_if<std::string>(&found))
      return {false, 0, {}, *why};
    const auto& head = std::get<explain::recording>(found).about;
    out.text += begin_of(*each, each == &x ? 'A' : 'B', head);
    seeds.push_back(head.seed);
  }
  if (seeds.front() != seeds.back())
    out.text += "They are of different seeds.\n";
  const auto has_line = skip_equal(x, y, out.equal, [](const lines& left, const lines& right) {
    return left.line == right.line;
  });
  out.differs = has_line.first || has_line.second;
  if (!out.differs) {
    out.text += "All " + report::counted(out.equal, "record") + " are equal.\n";
    return out;
  }
  out.text += "They part after " + report::counted(out.equal, "equal record") + ":\n";
  auto found = lines_of_both(x, y, has_line);
  const auto take = [&] {
    if (const auto* bad = std::get_if<bad_record>(&found))
      out.problem = bad->why;
    else
      out.text += std::get<std::string>(found);
    return out.problem.empty();
  };
  if (take() && has_line.first && has_line.second && differ_in_numbers(x, y)) {
    found = beyond_numbers(x, y);
    take();
  }
  return out;
}

} // namespace rubicon::cli
