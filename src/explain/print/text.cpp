#include "explain/print/text.hpp"

#include <algorithm>

#include "core/text/name.hpp"
#include "core/text/printable.hpp"
#include "explain/outcome.hpp"
#include "explain/print/words.hpp"
#include "explain/tree.hpp"
#include "report/figures.hpp"

namespace rubicon::explain {

namespace {

using report::align;
using report::cell;
using report::look;

constexpr std::size_t never_cut = 10'000; ///< what is too wide for a terminal, it wraps itself

std::string padded(const std::string& x, std::size_t width, bool to_the_right = false) {
  const std::string blanks(width - std::min(width, report::display_width(x)), ' ');
  return to_the_right ? blanks + x : x + blanks;
}

/// `text` in lines of `width` characters, broken at blanks; each but the first after `lead`.
std::string wrapped(const std::string& text, std::size_t width, const std::string& lead) {
  std::string out;
  std::string line;
  std::size_t from = 0;
  while (from <= text.size()) {
    const auto end = std::min(text.find(' ', from), text.size());
    const auto word = text.substr(from, end - from);
    if (!line.empty() && report::display_width(line) + 1 + report::display_width(word) > width) {
      out += line + '\n' + lead;
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
    from = end + 1;
  }
  return out + line;
}

/// The branches that go on below a row.
std::string branches_below(std::string_view where) {
  std::string out;
  for (;;) {
    if (where.starts_with("│ ") || where.starts_with("├ "))
      out += "│ ";
    else if (where.starts_with("└ ") || where.starts_with("  "))
      out += "  ";
    else
      return out;
    where.remove_prefix(where.starts_with(' ') ? 2 : std::string_view("│ ").size());
  }
}

/// Nothing is cut off: the whole path is shown.
std::string drawn(const tree& path, const text_style& style) {
  constexpr std::size_t what_min = 30;
  std::size_t time_width = report::display_width("time");
  std::size_t after_width = report::display_width("after");
  std::size_t where_width = report::display_width("where");
  auto rows = path.rows();
  for (auto& x : rows) {
    x.where = printable(x.where);
    x.what = printable(x.what);
    time_width = std::max(time_width, report::run_time(x.time).size());
    after_width = std::max(after_width, span(x.after).size());
    where_width = std::max(where_width, report::display_width(x.where));
  }
  const auto lead_width = 2 + time_width + 2 + after_width + 2 + where_width + 2;
  const auto what_width =
      style.width > lead_width + what_min ? style.width - lead_width : never_cut;
  const std::string before_where(2 + time_width + 2 + after_width + 2, ' ');
  const auto line = [&](const std::string& time, const std::string& after, const std::string& where,
                        const std::string& what, look how) {
    const auto lead = before_where + padded(branches_below(where), where_width) + "  ";
    return "  " + padded(time, time_width, true) + "  " +
           report::painted(padded(after, after_width, true), look::faint, style.colour) + "  " +
           report::painted(padded(where, where_width), how, style.colour) + "  " +
           report::painted(wrapped(what, what_width, lead), how, style.colour) + '\n';
  };
  auto text = line("time", "after", "where", "what", look::faint);
  for (const auto& x : rows)
    text +=
        line(report::run_time(x.time), x.is_first ? "" : span(x.after), x.where, x.what, x.look);
  return text;
}

std::string title(const std::string& text, const text_style& style) {
  return report::painted(printable(text), look::strong, style.colour) + "\n\n";
}

/// `2 radio repeats, 1 serial repeat, 2 attempts`
std::string effort(const retries& x) {
  std::string text;
  const auto add = [&](std::uint32_t count, const char* noun) {
    if (count > 0)
      text += "; " + report::counted(count, noun);
  };
  add(x.radio, "radio repeat");
  add(x.serial, "serial repeat");
  add(x.peis, "PEIS repeat");
  if (x.transport > 0)
    text += "; " + std::to_string(x.transport + 1) + " attempts end to end";
  return text;
}

std::string conclusion(const traces& all, const message& x, const text_style& style) {
  const auto y = outcome_of(all, x);
  std::string text;
  auto how = look::good;
  switch (y.status) {
  case message_status::delivered:
    text = "delivered after " + span(*y.took);
    if (x.acknowledged)
      text += ", acknowledged after " + span(*x.acknowledged - all.nodes[x.root].begin);
    else if (x.failed)
      text += ", though reported failed to the sender at " + report::run_time(*x.failed);
    else if (x.is_reliable)
      text += ", no acknowledgement reached the sender";
    break;
  case message_status::lost:
    how = look::bad;
    text = "lost" + (y.where.empty() ? ": " : " between " + y.where + ": ") + y.why;
    if (x.failed)
      text += "; reported failed to the sender at " + report::run_time(*x.failed);
    break;
  case message_status::refused:
    how = look::bad;
    text = "refused: " + y.why;
    break;
  case message_status::in_flight:
    how = look::plain;
    text = "in flight when the record ends" + (y.why.empty() ? "" : " (" + y.why + ')');
    break;
  }
  return report::painted(printable(text + effort(y.retries)), how, style.colour) + '\n';
}

/// Faults of the ecology shortly before a time, and until another.
/// @param key whose writes are listed too; empty: of none
std::string around(const traces& all, instant from, instant to, const text_style& style,
                   const std::string& key = {}) {
  constexpr std::size_t lines_max = 5;
  constexpr duration shortly = 60s;
  report::table rows({{"around then", align::right}, {"who"}, {"what"}});
  std::size_t lines = 0;
  for (const auto& x : all.events) {
    const bool is_fault = x.from.starts_with("serial_line/") || x.from.starts_with("backbone/") ||
                          x.from.starts_with("peis_peer/") || x.from.starts_with("ecology/") ||
                          x.text.starts_with("crashed") || x.text.starts_with("battery") ||
                          (!key.empty() && x.text.starts_with(key + " = "));
    if (is_fault && x.time + shortly >= from && x.time <= to && ++lines <= lines_max)
      rows.add({report::run_time(x.time), names::of(x.from), printable(x.text)});
  }
  return rows.empty() ? "" : '\n' + rows.render(never_cut, style.colour);
}

std::string cut_note(const traces& all) {
  return all.cut_off ? "The record ends in the middle of a line: the run was killed.\n" : "";
}

/// Whether `name` occurs in `text` as a whole word.
bool mentions(const std::string& text, const std::string& name) {
  const auto is_part = [](char c) { return is_name_character(c) || c == '/'; };
  for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const auto end = at + name.size();
    if ((at == 0 || !is_part(text[at - 1])) && (end == text.size() || !is_part(text[end])))
      return true;
  }
  return false;
}

/// The answer, and what people call those that it names: `kitchen/fan is Lüfter / Küche`
std::string with_labels(const traces& all, std::string text) {
  std::string labels;
  for (const auto& [name, label] : all.about.labels)
    if (mentions(text, name))
      labels += "  " + printable(name) + " is " + printable(label) + '\n';
  return text + (labels.empty() ? "" : '\n' + labels);
}

/// The name by which a value can be asked for: with its owner if others have such a tuple.
std::string full_key(const traces& all, const tuple_value& x) {
  return x.key + '@' + all.known.of(x.owner);
}

instant end_of(const traces& all, const message& x) {
  auto end = all.nodes[x.root].begin;
  for (const auto n : x.nodes)
    end = std::max(end, all.nodes[n].time());
  return end;
}

/// Proxies publish the unit of `a.b` as `a.b.unit`.
std::string unit_of(const traces& all, const tuple_value& x) {
  const auto is_unit = [&](const tuple_value& y) {
    return y.owner == x.owner && y.is_text && !y.is_deletion && y.key == x.key + ".unit";
  };
  const auto found = std::ranges::find_if(all.tuples, is_unit);
  return found == all.tuples.end() || x.is_deletion ? "" : ' ' + value_text(found->value, true);
}

bool is_from(const traces& all, const message& x, const std::string& from) {
  const auto name = all.known.of(x.source);
  return from.empty() || name == from || name.starts_with(from + '/');
}

} // namespace

std::string message_text(const traces& all, std::size_t index, const text_style& style) {
  const auto& x = all.messages[index];
  tree path(all);
  path.add_path_to(x.root);
  path.add(x.root);
  auto text =
      title(x.name + " to " + all.known.of(x.destination), style) + drawn(path, style) + '\n';
  text += conclusion(all, x, style);
  if (!x.delivered)
    text += around(all, all.nodes[x.root].begin, end_of(all, x), style);
  return with_labels(all, std::move(text)) + cut_note(all);
}

std::string tuple_text(const traces& all, std::size_t index, const text_style& style) {
  const auto& x = all.tuples[index];
  tree path(all);
  path.add_path_to(x.root);
  const auto begun = path.rows().empty() ? all.nodes[x.root].begin : path.rows().front().time;
  path.add(x.root);
  auto text = title(assignment(x) + unit_of(all, x), style) + drawn(path, style) + '\n';
  if (!x.set) {
    text += report::painted("never set: it did not reach " + printable(all.known.of(x.owner)),
                            look::bad, style.colour) +
            '\n';
    return text + around(all, begun, all.nodes[x.root].begin + 60s, style, x.key) + cut_note(all);
  }
  text += "set at " + printable(all.known.of(x.owner)) +
          (*x.set > begun ? " after " + span(*x.set - begun) : "");
  const auto receivers = audience_of(all, x);
  if (receivers.empty())
    text += "; no subscriber";
  for (const auto& who : receivers)
    text += who.after ? "\n" + printable(who.who) + " received it after " +
                            span(*x.set - begun + *who.after)
                      : "\n" + report::painted(printable(who.who) + " did not receive it",
                                               look::bad, style.colour);
  return with_labels(all, text + '\n') + cut_note(all);
}

std::string values_text(const traces& all, const std::vector<std::size_t>& indices,
                        std::size_t limit, const text_style& style) {
  report::table rows({{"time", align::right}, {"value"}, {"by"}, {"received by"}});
  const auto first = limit != 0 && indices.size() > limit ? indices.size() - limit : 0;
  for (auto i = first; i < indices.size(); ++i) {
    const auto& x = all.tuples[indices[i]];
    std::string receivers;
    for (const auto& who : audience_of(all, x))
      receivers += (receivers.empty() ? "" : ", ") + who.who + (who.after ? "" : " (not)");
    rows.add({report::run_time(all.nodes[x.root].begin),
              x.is_deletion ? "deleted" : value_text(x.value, x.is_text), names::of(x.writer),
              x.set ? receivers : "never set"});
  }
  const auto key = full_key(all, all.tuples[indices.front()]);
  auto text = title(printable(key) + ", " + report::counted(indices.size(), "value") +
                        (first > 0 ? ", the newest " + std::to_string(limit) : ""),
                    style);
  return with_labels(all, text + rows.render(style.room, style.colour)) + cut_note(all);
}

// ----------------------------------------------------------------------------------------- listing

std::vector<std::size_t> selected(const traces& all, const listing& asked) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < all.messages.size(); ++i) {
    const auto& x = all.messages[i];
    if (!is_from(all, x, asked.from))
      continue;
    const auto how = asked.lost_only ? outcome_of(all, x).status : message_status::lost;
    if (how == message_status::lost || how == message_status::refused)
      out.push_back(i);
  }
  if (asked.limit != 0 && out.size() > asked.limit)
    out.erase(out.begin(), out.end() - static_cast<std::ptrdiff_t>(asked.limit));
  return out;
}

std::vector<std::pair<std::string, std::size_t>> loss_causes(const traces& all,
                                                             const listing& asked) {
  std::map<std::string, std::size_t> counts;
  for (const auto& x : all.messages) {
    if (!is_from(all, x, asked.from))
      continue;
    const auto how = outcome_of(all, x);
    if (how.status == message_status::lost || how.status == message_status::refused)
      ++counts[how.status == message_status::refused ? "refused: " + how.obstacle
               : how.where.empty()                   ? how.obstacle
                                                     : how.where + ": " + how.obstacle];
  }
  std::vector<std::pair<std::string, std::size_t>> sorted(counts.begin(), counts.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return sorted;
}

namespace {

/// A bar for each cause, the longest for the most frequent.
std::string histogram(const traces& all, const listing& asked, const text_style& style) {
  constexpr std::size_t bar_max = 30;
  constexpr std::size_t rows_max = 20;
  const auto causes = loss_causes(all, asked);
  if (causes.empty())
    return {};
  report::table rows({{"lost", align::right}, {""}, {"why"}});
  for (std::size_t i = 0; i < std::min(rows_max, causes.size()); ++i) {
    std::string bar;
    for (std::size_t k = 0;
         k < std::max<std::size_t>(1, bar_max * causes[i].second / causes.front().second); ++k)
      bar += "█";
    rows.add({std::to_string(causes[i].second), bar, causes[i].first});
  }
  if (causes.size() > rows_max)
    rows.add_note("… and " + std::to_string(causes.size() - rows_max) + " causes more");
  return rows.render(style.room, style.colour) + '\n';
}

} // namespace

std::string list_text(const traces& all, const listing& asked, const text_style& style) {
  report::table rows({{"time", align::right},
                      {"message"},
                      {"to"},
                      {"content"},
                      {"after", align::right},
                      {"outcome"}});
  const auto shown = selected(all, asked);
  auto unlimited = asked;
  unlimited.limit = 0;
  const auto fits = asked.limit == 0 ? shown.size() : selected(all, unlimited).size();
  std::size_t counts[4] = {};
  for (const auto& x : all.messages)
    if (is_from(all, x, asked.from))
      ++counts[static_cast<std::size_t>(outcome_of(all, x).status)];
  for (const auto i : shown) {
    const auto& x = all.messages[i];
    const auto how = outcome_of(all, x);
    const bool is_bad = how.status == message_status::lost || how.status == message_status::refused;
    rows.add(
        {report::run_time(all.nodes[x.root].begin),
         x.name,
         all.known.of(x.destination),
         x.content || is_event(x) ? content_text(x) : "",
         how.took ? span(*how.took) : "",
         {std::string(to_string(how.status)) +
              (how.why.empty() ? "" : ": " + (how.where.empty() ? "" : how.where + ", ") + how.why),
          is_bad ? look::bad : look::plain}});
  }
  const auto of = [&](message_status x) { return counts[static_cast<std::size_t>(x)]; };
  const auto total = of(message_status::delivered) + of(message_status::lost) +
                     of(message_status::refused) + of(message_status::in_flight);
  auto text =
      title(printable(all.about.ecology) + ", seed " + std::to_string(all.about.seed) + ", " +
                report::run_time(all.end) + ": " + report::counted(total, "message") +
                (asked.from.empty() ? "" : " from " + printable(asked.from)) + ", " +
                std::to_string(of(message_status::delivered)) + " delivered, " +
                std::to_string(of(message_status::lost) + of(message_status::refused)) + " lost, " +
                std::to_string(of(message_status::in_flight)) + " in flight",
            style);
  text += histogram(all, asked, style) + rows.render(style.room, style.colour);
  if (fits > shown.size())
    text += "  … and " + std::to_string(fits - shown.size()) + " before (--limit 0 shows all)\n";
  if (asked.lost_only || !asked.from.empty())
    return with_labels(all, std::move(text)) + cut_note(all);
  std::map<std::pair<std::string, peer_id>, std::pair<std::size_t, std::size_t>> keys;
  for (std::size_t i = 0; i < all.tuples.size(); ++i) {
    auto& entry = keys[{all.tuples[i].key, all.tuples[i].owner}]; // how many, and the newest
    ++entry.first;
    entry.second = i;
  }
  report::table tuples(
      {{"tuple"}, {"of"}, {"values", align::right}, {"newest"}, {"since", align::right}});
  std::size_t left = asked.limit == 0 ? keys.size() : asked.limit;
  for (const auto& [key, entry] : keys) {
    const auto& x = all.tuples[entry.second];
    if (x.key.starts_with("kernel.") || entry.first < 2 || left == 0)
      continue; // of little interest: nothing ever happens to them
    --left;
    tuples.add({printable(x.key), all.known.of(x.owner), std::to_string(entry.first),
                x.is_deletion ? "deleted" : value_text(x.value, x.is_text),
                report::run_time(all.nodes[x.root].begin)});
  }
  text += '\n' + tuples.render(style.room, style.colour);
  return with_labels(all, std::move(text)) + cut_note(all);
}

// ------------------------------------------------------------------------------------------- names

namespace {

std::string folded(std::string_view x) {
  std::string y(x);
  for (auto& c : y)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return y;
}

} // namespace

std::variant<nothing_found, message_found, tuples_found> find(const traces& all,
                                                              std::string_view name) {
  const auto wanted = folded(name);
  nothing_found known;
  const auto hash = name.find('#');
  if (hash != std::string_view::npos || name.find('/') != std::string_view::npos) {
    std::map<std::string, std::size_t> counts;
    for (std::size_t i = 0; i < all.messages.size(); ++i) {
      const auto& x = all.messages[i];
      const auto numbered = to_string(x.source) + x.name.substr(x.name.find('#'));
      if (folded(x.name) == wanted || numbered == wanted)
        return message_found{i};
      ++counts[all.known.of(x.source)];
    }
    const auto sender = std::string(name.substr(0, hash));
    for (const auto& [who, count] : counts)
      known.known.push_back(who + "#1" + (count > 1 ? ".." + std::to_string(count) : ""));
    for (const auto& [who, count] : counts)
      if (folded(who) == folded(sender) || folded(who).ends_with('/' + folded(sender)))
        known.known = {who + "#1" + (count > 1 ? ".." + std::to_string(count) : "")};
    return known;
  }
  tuples_found values;
  std::map<std::string, std::size_t> owners; // of tuples with this key
  std::map<std::string, std::size_t> keys;
  for (std::size_t i = 0; i < all.tuples.size(); ++i) {
    const auto& x = all.tuples[i];
    const auto full = full_key(all, x);
    ++keys[x.key];
    if (folded(x.key) != wanted && folded(full) != wanted)
      continue;
    values.indices.push_back(i);
    ++owners[full];
  }
  if (owners.size() == 1)
    return values;
  known.is_ambiguous = !owners.empty();
  for (const auto& [key, count] : owners.empty() ? keys : owners)
    known.known.push_back(key);
  // First those that begin likewise, and last what gateways and kernels keep about themselves.
  const auto rank = [start = wanted.substr(0, wanted.find('.'))](const std::string& key) {
    const bool is_own = key.starts_with("devices") || key.starts_with("kernel.");
    return folded(key.substr(0, key.find('.'))) == start ? 0 : is_own ? 2 : 1;
  };
  std::ranges::stable_sort(known.known, {}, rank);
  return known;
}

std::optional<std::size_t> value_at(const traces& all, const std::vector<std::size_t>& indices,
                                    instant when) {
  std::optional<std::size_t> newest;
  for (const auto i : indices)
    if (all.nodes[all.tuples[i].root].begin <= when)
      newest = i;
  return newest;
}

} // namespace rubicon::explain
