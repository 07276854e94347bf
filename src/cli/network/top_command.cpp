#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "cli/network/session.hpp"
#include "cli/network/top_text.hpp"
#include "cli/print/console.hpp"
#include "cli/print/local_time.hpp"
#include "cli/print/screen.hpp"
#include "io/process/signal_watch.hpp"
#include "peis/wire/routing_page.hpp"

namespace rubicon::cli {

namespace {

constexpr duration look_for_keys_every = 100ms;

/// Everybody but ourselves.
std::map<peer_id, top_host> hosts_of(const session& at) {
  std::map<peer_id, top_host> all;
  for (const auto* x : at.peer().network().hosts.records())
    all[x->id].name = x->full_name;
  for (const auto& [host, route] : at.peer().kernel().network().routes.routes().routes()) {
    if (route.lost())
      continue;
    all[host].metric = route.hops;
    if (route.connections != peis::connections_unknown)
      all[host].links = route.connections;
  }
  all.erase(at.peer().kernel().id());
  return all;
}

/// Pictures of a network, one after the other.
class top_show {
public:
  top_show(const session& at, const show_top& options) : at_(at), options_(options) {}

  [[nodiscard]] exit_status perform() {
    const auto on_change = [this](const auto& x) { note(*x); };
    const scoped_subscription watch(at_, any_peer, "", on_change, on_change);
    if (const auto* why = watch.refused())
      return fail("refused: " + std::string(peis::to_string(*why)));
    static_cast<void>(
        at_.self.await_quiet([this] { return hosts_seen() > 0; }, [this] { return hosts_seen(); }));
    seen_.restart(); // what has come so far has been there before
    last_ = at_.peer().now();
    const auto status = show();
    return status == exit_status::failed ? fail("the link to " + at_.with.peer + " is gone")
                                         : status;
  }

private:
  void note(const peis::tuple& x) {
    if (x.owner != at_.peer().kernel().id())
      seen_.on_change(x);
  }

  [[nodiscard]] std::size_t hosts_seen() const {
    return at_.peer().kernel().network().routes.routes().routes().size();
  }

  [[nodiscard]] exit_status show() {
    std::optional<screen> full;
    if (has_screen() && !options_.once && !at_.with.json)
      full.emplace();
    bool interrupted = false;
    const io::signal_watch signals(at_.loop, [&](int) { interrupted = true; });
    const auto pictures = options_.once ? 1 : options_.count.value_or(0);
    auto next = last_ + (full ? std::min(options_.every, look_for_keys_every) : options_.every);
    for (std::uint64_t shown = 0;;) {
      if (interrupted)
        return exit_status::interrupted;
      if (at_.peer().links().open_links() == 0)
        return exit_status::failed;
      if (full)
        if (const auto key = full->key();
            key && std::tolower(static_cast<unsigned char>(*key)) == 'q')
          return exit_status::good;
      const auto now = at_.peer().now();
      if (now < next) {
        at_.peer().step(std::min(next - now, look_for_keys_every));
        continue;
      }
      next = std::max(next + options_.every, now);
      if (!draw(full, shown > 0))
        return exit_status::refused;
      if (++shown == pictures)
        return exit_status::good;
    }
  }

  [[nodiscard]] bool draw(const std::optional<screen>& full, bool has_shown) {
    auto all = at_.peer().kernel().reader().find_all(any_peer, "");
    std::erase_if(all, [this](const auto& x) { return x->owner == at_.peer().kernel().id(); });
    const auto now = at_.peer().now();
    auto picture = seen_.look(hosts_of(at_), all, now - std::exchange(last_, now));
    picture.network = at_.with.network;
    picture.via = at_.with.peer;
    picture.time = clock_now(false);
    if (full)
      return full->draw(
          top_text(picture, full->width(), full->height(), console_of(stdout).colour));
    if (at_.with.json)
      return print(stdout, top_json(picture));
    const auto output = console_of(stdout);
    return print(stdout, (has_shown ? "\n" : "") +
                             top_text(picture, output.room(), std::nullopt, output.colour));
  }

  const session& at_;
  const show_top& options_;
  top_observer seen_;
  instant last_;
};

} // namespace

exit_status perform(const session& at, const show_top& x) {
  return top_show(at, x).perform();
}

} // namespace rubicon::cli
