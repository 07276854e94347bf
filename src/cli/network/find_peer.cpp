#include <algorithm>
#include <deque>
#include <set>
#include <utility>

#include "cli/network/session.hpp"
#include "report/figures.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t listed_max = 12; ///< in an error

/// `care-pc` of `care-pc@basement!4711`, or all of it.
bool is_called(const peis::host_record& x, const std::string& name) {
  return x.full_name == name || x.full_name.substr(0, x.full_name.find('@')) == name;
}

/// Everybody but ourselves.
std::vector<peer_id> called(const session& at, const std::string& name) {
  std::vector<peer_id> all;
  for (const auto* x : at.peer().network().hosts.records())
    if (x->id != at.peer().kernel().id() && is_called(*x, name))
      all.push_back(x->id);
  return all;
}

/// `7 (lamp@hall!3), 9`
template <class Peers>
std::string list(const session& at, const Peers& all) {
  std::string text;
  std::size_t listed = 0;
  for (const auto host : all) {
    if (listed++ == listed_max)
      return text + " and " + report::counted(all.size() - listed_max, "other");
    const auto name = name_of(at, host);
    text += (text.empty() ? "" : ", ") + to_string(host) + (name.empty() ? "" : " (" + name + ')');
  }
  return text;
}

/// Who has one of the tuples now; ours describe only this command.
std::set<peer_id> holders(const session& at, const std::vector<std::string>& keys) {
  std::set<peer_id> all;
  for (const auto& key : keys)
    for (const auto& x : at.peer().kernel().reader().find_all(any_peer, key))
      if (x->owner != at.peer().kernel().id())
        all.insert(x->owner);
  return all;
}

std::string words_of(const std::vector<std::string>& keys) {
  return '`' + keys.front() + '`';
}

} // namespace

std::string name_of(const session& at, peer_id host) {
  for (const auto* x : at.peer().network().hosts.records()) {
    if (x->id == host)
      return x->full_name;
  }
  return {};
}

std::variant<peer_id, std::string> find_peer(const session& at, const peer_selector& x) {
  if (x.id) {
    if (at.self.await_host(*x.id))
      return *x.id;
    return "no peer " + to_string(*x.id) + " in the network `" + at.with.network +
           "`; rubicon hosts lists them";
  }
  static_cast<void>(
      at.self.await_quiet([&] { return !called(at, x.name).empty(); },
                          [&] { return at.peer().network().hosts.records().size(); }));
  const auto all = called(at, x.name);
  if (all.empty())
    return "no peer is named `" + x.name + "` in the network `" + at.with.network +
           "`; rubicon hosts lists them";
  if (all.size() > 1)
    return "several peers are named `" + x.name + "`: " + list(at, all) + "; give its id";
  if (!at.self.await_host(all.front()))
    return "no route to peer " + list(at, all);
  return all.front();
}

std::variant<peer_id, std::string> find_owner(const session& at, const peer_selector& x,
                                              const std::vector<std::string>& keys) {
  if (!x.is_any())
    return find_peer(at, x);
  std::size_t news = 0;
  std::deque<scoped_subscription> watches;
  for (const auto& key : keys)
    watches.emplace_back(at, any_peer, key, [&news](const auto&) { ++news; });
  static_cast<void>(
      at.self.await_quiet([&] { return !holders(at, keys).empty(); },
                          [&] { return news + at.peer().network().hosts.records().size(); }));
  const auto all = holders(at, keys);
  if (all.empty())
    return "no peer has a tuple " + words_of(keys) + "; give its owner with --owner PEER";
  if (all.size() > 1)
    return "several peers have a tuple " + words_of(keys) + ": " + list(at, all) +
           "; choose one with --owner PEER";
  return *all.begin();
}

} // namespace rubicon::cli
