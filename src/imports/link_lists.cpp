// Links as lists: TOSSIM's gains, and the topology of RIOT's ZEP dispatcher.
#include <algorithm>
#include <set>

#include "imports/readers.hpp"
#include "radio/medium/tossim_files.hpp"

namespace rubicon::imports {

namespace {

/// Such a link loses what its weight says and nothing else.
constexpr double clear_gain_db = -60;

/// TOSSIM's own reader says no column: the first field of the line.
text_place first_field(std::string_view text, std::size_t line) {
  line_fields lines(text, " \t");
  while (lines.next())
    if (lines.number() == line)
      return lines.fields().empty() ? text_place{line, 1} : lines.fields().front().at;
  return {};
}

class zep_reader {
public:
  import_result read(std::string_view text) {
    line_fields lines(text, " \t");
    while (lines.next())
      take(lines);
    out_.plan.air = listed_links{};
    return finished(std::move(out_), motes_, notes_);
  }

private:
  void take(const line_fields& lines) {
    const auto& fields = lines.fields();
    if (fields.empty() || fields.front().text.starts_with('#'))
      return;
    if (fields.size() < 2 || fields.size() > 4)
      refuse(fields.front().at, "expected two nodes and one or two weights from 0 to 1");
    if (fields.size() == 2)
      refuse(lines.end(), "a weight is missing");
    const auto a = motes_.by_name(fields[0].text, fields[0].at);
    const auto b = motes_.by_name(fields[1].text, fields[1].at);
    if (a == b)
      refuse(fields[1].at, "a link leads from one node to another");
    const auto there = real_of(fields[2], "a weight", 0, 1);
    const auto back = fields.size() == 4 ? real_of(fields[3], "a weight", 0, 1) : there;
    add(a, b, there, fields[1].at);
    add(b, a, back, fields[1].at);
  }

  void add(std::size_t from, std::size_t to, double weight, text_place at) {
    if (!seen_.insert({from, to}).second)
      refuse(at, "the link is already listed");
    if (out_.plan.links.size() == links_max)
      refuse(at, "there are more than " + std::to_string(links_max) + " links");
    if (weight > 0)
      out_.plan.links.push_back({from, to, 1 - weight, clear_gain_db});
  }

  imported out_;
  mote_list motes_;
  note_list notes_;
  std::set<std::pair<std::size_t, std::size_t>> seen_;
};

} // namespace

import_result read_tossim(std::string_view text) {
  auto read = radio::read_topology(text);
  if (auto* why = std::get_if<radio::file_problem>(&read))
    refuse(first_field(text, why->line), std::move(why->message));
  const auto& table = std::get<radio::gain_table>(read);
  imported out;
  mote_list motes;
  for (const auto& each : table.gains) {
    static_cast<void>(motes.by_number(each.from, {}));
    static_cast<void>(motes.by_number(each.to, {}));
  }
  motes.give(out.plan);
  if (const auto last = out.plan.motes.back().number; last > node_max)
    refuse({}, "a node must be a number from 0 to " + std::to_string(node_max) + ", not " +
                   std::to_string(last));
  std::size_t with_noise = 0;
  for (const auto& each : table.floors)
    with_noise += std::ranges::binary_search(out.plan.motes, each.node, {}, &planned_mote::number);
  const bool all_have_noise = with_noise == out.plan.motes.size();
  out.plan.air = topology_file{out.plan.motes.front().number, all_have_noise};
  if (with_noise < table.floors.size())
    out.notes.push_back({{}, "`noise` of nodes that have no `gain`: they are no motes"});
  if (all_have_noise)
    out.notes.push_back({{}, "deviations of `noise` lines: each node's floor is constant"});
  else if (with_noise > 0)
    out.notes.push_back({{}, "`noise` lines, as some nodes have none: the usual noise instead"});
  return out;
}

import_result read_zep(std::string_view text) {
  return zep_reader().read(text);
}

} // namespace rubicon::imports
