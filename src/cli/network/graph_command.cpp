#include <map>
#include <set>
#include <string>
#include <utility>

#include "cli/network/graph_text.hpp"
#include "cli/network/session.hpp"
#include "cli/print/console.hpp"

namespace rubicon::cli {

namespace {

/// A list that was written since we have subscribed has us in it, or is too long to show it.
bool has_us(const session& at, const peis::tuple& list) {
  const auto text = list.text();
  return text.find("( " + to_string(at.peer().kernel().id()) + ' ') != std::string_view::npos ||
         text.find("\n  ...\n") != std::string_view::npos;
}

/// Whether every reachable peer has published its list of subscribers.
bool all_have_published(const session& at) {
  std::set<peer_id> published;
  for (const auto& x : at.peer().kernel().reader().find_all(any_peer, "kernel.subscribers"))
    if (has_us(at, *x))
      published.insert(x->owner);
  for (const auto& [host, route] : at.peer().kernel().network().routes.routes().routes())
    if (!route.lost() && host != at.peer().kernel().id() && !published.contains(host))
      return false;
  return !published.empty();
}

} // namespace

exit_status perform(const session& at, const show_graph& x) {
  const scoped_subscription watch(at, any_peer, "", {});
  if (const auto* why = watch.refused())
    return fail("refused: " + std::string(peis::to_string(*why)));
  static_cast<void>(
      at.self.await_quiet([&] { return all_have_published(at); },
                          [&] { return at.peer().network().hosts.records().size(); }));
  std::map<peer_id, std::string> names;
  for (const auto& [host, route] : at.peer().kernel().network().routes.routes().routes())
    if (!route.lost())
      names[host];
  for (const auto* host : at.peer().network().hosts.records())
    names[host->id] = host->full_name;
  const auto graph = graph_of(std::move(names), at.peer().kernel().reader().find_all(any_peer, ""),
                              at.peer().kernel().id(), x.all);
  if (at.with.json)
    return answer(to_json(graph));
  if (x.dot)
    return answer(to_dot(graph));
  const auto output = console_of(stdout);
  return answer(graph_text(graph, output.room(), output.colour));
}

} // namespace rubicon::cli
