#include "explain/tree.hpp"

#include <algorithm>

#include "explain/outcome.hpp"
#include "explain/print/words.hpp"
#include "report/figures.hpp"

namespace rubicon::explain {

namespace {

constexpr std::size_t indent_max = 200; ///< traces of messages that set off each other without end

bool is_hop_of(const node& x, cargo of) {
  return x.what == step::hop && x.of == of;
}

} // namespace

void tree::add(node_index root) {
  const auto first = plain(root);
  const auto before = rows_.empty() ? first.time : rows_.back().time;
  show(first, before, "", "");
}

void tree::add_path_to(node_index n) {
  std::vector<node_index> path;
  for (auto x = at(n).parent; x != no_node && path.size() < indent_max; x = at(x).parent)
    path.push_back(x);
  std::ranges::reverse(path);
  for (std::size_t i = 0; i < path.size(); ++i) {
    auto row = plain(path[i]);
    const auto& x = at(path[i]);
    if (x.over == medium::peis) { // the hops of one package are one row
      while (i + 1 < path.size() && at(path[i + 1]).over == medium::peis &&
             at(path[i + 1]).about == x.about) {
        ++i;
        row.where += " → " + names::of(at(path[i]).to);
        row.time = at(path[i]).time();
      }
    }
    const auto before = rows_.empty() ? row.time : rows_.back().time;
    rows_.push_back({row.time, row.time - before, rows_.empty(), row.where, row.what, row.look});
  }
}

/// @param lead before the rows that follow
/// @param own_lead before this row
void tree::show(const block& x, instant before, const std::string& lead,
                const std::string& own_lead) {
  rows_.push_back({x.time, x.time - before, rows_.empty(), own_lead + x.where, x.what, x.look});
  const auto next = blocks_of(x.then);
  constexpr std::size_t rows_max = 2000;
  if (next.empty() || rows_.size() > rows_max || lead.size() > indent_max)
    return;
  if (next.size() == 1) {
    show(next.front(), x.time, lead, lead);
    return;
  }
  for (std::size_t i = 0; i < next.size(); ++i) {
    const bool is_last = i + 1 == next.size();
    show(next[i], x.time, lead + (is_last ? "  " : "│ "), lead + (is_last ? "└ " : "├ "));
  }
}

/// Whether the content gets from here to where the message is to go.
bool tree::leads_on(node_index n) const {
  const auto& x = at(n);
  const auto& m = all_.messages[x.about.index];
  if (x.arrived && m.delivered && *x.arrived == *m.delivered && x.of == cargo::content)
    return true;
  return std::ranges::any_of(x.children, [&](node_index child) {
    return at(child).about == x.about && is_hop_of(at(child), cargo::content) && leads_on(child);
  });
}

std::vector<tree::block> tree::blocks_of(const std::vector<node_index>& children) const {
  std::vector<block> out;
  std::vector<node_index> greetings;
  std::vector<node_index> attempts;
  std::vector<node_index> leaves;
  for (const auto n : children) {
    const auto& x = at(n);
    const bool from_root = x.parent != no_node && at(x.parent).what == step::sends;
    if (is_hop_of(x, cargo::greeting) && from_root)
      greetings.push_back(n);
    else if (is_hop_of(x, cargo::content) && from_root && !x.about.is_tuple)
      attempts.push_back(n);
    else if (x.what == step::sets && x.children.empty())
      leaves.push_back(n);
  }
  const auto is_in = [](const std::vector<node_index>& in, node_index n) {
    return std::ranges::find(in, n) != in.end();
  };
  if (!greetings.empty())
    out.push_back(greeting(greetings));
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    const bool in_full =
        leads_on(attempts[i]) ||
        (i + 1 == attempts.size() && !all_.messages[at(attempts[i]).about.index].delivered);
    out.push_back(in_full ? plain(attempts[i])
                          : failed_attempt(attempts[i], i + 1, attempts.size()));
    if (in_full && attempts.size() > 1)
      out.back().what = "attempt " + std::to_string(i + 1) + ", " + out.back().what;
  }
  if (!leaves.empty())
    out.push_back(settings(leaves));
  for (const auto n : children) {
    const auto& x = at(n);
    if (is_in(greetings, n) || is_in(attempts, n) || is_in(leaves, n))
      continue;
    if (is_hop_of(x, cargo::answer) || is_hop_of(x, cargo::greeting_answer))
      out.push_back(answer(n));
    else
      out.push_back(x.over == medium::peis ? package_chain(n) : plain(n));
  }
  std::ranges::stable_sort(out, {}, &block::time);
  return out;
}

tree::block tree::plain(node_index n) const {
  const auto& x = at(n);
  block out;
  out.first = n;
  out.then = x.children;
  out.where = explain::where(all_, x);
  out.what = explain::what(all_, x);
  out.time = x.time();
  if (x.what == step::hop && !x.arrived)
    out.look = report::look::bad;
  return out;
}

/// Hops of a package to one peer, as long as nothing else happens meanwhile.
tree::block tree::package_chain(node_index n) const {
  auto out = plain(n);
  std::uint32_t repeated = repeats(at(n));
  auto last = n;
  std::size_t hops = 1;
  while (at(last).children.size() == 1 && at(last).arrived) {
    const auto next = at(last).children.front();
    const auto& x = at(next);
    if (x.over != medium::peis || x.about != at(n).about || !x.arrived)
      break;
    out.where += " → " + names::of(x.to);
    repeated += repeats(x);
    ++hops;
    last = next;
  }
  if (hops > 1) {
    out.what = "PEIS: received over " + std::to_string(hops) + " hops";
    if (repeated > 0)
      out.what += ", " + std::to_string(repeated) + " packages repeated";
    out.time = at(last).time();
    out.then = at(last).children;
  }
  return out;
}

/// All questions and answers before the first message to somebody.
tree::block tree::greeting(const std::vector<node_index>& hops) const {
  const auto& m = all_.messages[at(hops.front()).about.index];
  block out;
  out.where = all_.known.of(m.source);
  out.what = "greets " + all_.known.of(m.destination) + " first";
  if (hops.size() > 1)
    out.what += ", " + std::to_string(hops.size()) + " times";
  out.time = at(hops.back()).time();
  bool answered = false;
  for (const auto n : m.nodes) {
    const auto& x = at(n);
    if (x.of == cargo::greeting_answer && x.arrived && x.to == at(hops.front()).from) {
      out.time = *x.arrived;
      answered = true;
      break;
    }
  }
  if (!answered) {
    const node* furthest = &at(hops.back());
    for (const auto n : m.nodes)
      if (at(n).of == cargo::greeting || at(n).of == cargo::greeting_answer)
        furthest = &at(n);
    out.what += ": no answer";
    if (!furthest->arrived)
      out.what += " (" + route_of(*furthest) + ": " + obstacle(*furthest) + ')';
    out.look = report::look::bad;
  } else {
    out.what += ": answered";
  }
  return out;
}

/// An acknowledgement on its route back, in one row.
tree::block tree::answer(node_index n) const {
  auto out = plain(n);
  auto last = n;
  std::uint32_t repeated = repeats(at(n));
  for (;;) {
    const node* next = nullptr;
    for (const auto child : at(last).children)
      if (is_hop_of(at(child), at(n).of) && at(child).about == at(n).about) {
        last = child;
        next = &at(child);
      }
    if (next == nullptr)
      break;
    repeated += repeats(*next);
  }
  const auto& end = at(last);
  out.where = end.arrived ? names::of(at(n).from) + " → " + names::of(end.to) : route_of(end);
  out.time = end.time();
  out.then.clear();
  for (const auto child : end.children)
    if (!is_hop_of(at(child), at(n).of))
      out.then.push_back(child);
  out.what = at(n).text + (end.arrived ? ": received" : ": LOST, " + obstacle(end));
  if (end.arrived && repeated > 0)
    out.what += " after " + report::counted(repeated, "repeat");
  out.look = end.arrived ? report::look::faint : report::look::bad;
  return out;
}

/// An attempt of Transport that did not get there, or was not the first that did.
tree::block tree::failed_attempt(node_index n, std::size_t number, std::size_t of) const {
  auto last = n;
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (const auto child : at(last).children)
      if (is_hop_of(at(child), cargo::content) && at(child).about == at(n).about) {
        last = child;
        goes_on = true;
        break;
      }
  }
  block out;
  out.where = route_of(at(last));
  out.time = at(n).begin;
  const auto& m = all_.messages[at(n).about.index];
  out.what = "attempt " + std::to_string(number) + " of " + std::to_string(of) + ": ";
  if (!at(last).arrived) {
    out.what += "LOST, " + obstacle(at(last));
    out.look = report::look::bad;
  } else if (m.delivered && *m.delivered <= at(n).begin) {
    out.what += "received again";
    out.look = report::look::faint;
  } else {
    out.what += "went no further";
    out.look = report::look::bad;
  }
  return out;
}

/// Values that nobody does anything with.
tree::block tree::settings(const std::vector<node_index>& leaves) const {
  auto out = plain(leaves.front());
  for (std::size_t i = 1; i < leaves.size(); ++i)
    out.what += ", " + assignment(all_.tuples[at(leaves[i]).about.index]);
  if (leaves.size() > 3)
    out.what = "sets " + assignment(all_.tuples[at(leaves.front()).about.index]) + " and " +
               std::to_string(leaves.size() - 1) + " others";
  out.look = report::look::faint;
  out.then.clear();
  return out;
}

} // namespace rubicon::explain
