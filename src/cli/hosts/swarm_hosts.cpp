#include "cli/hosts/swarm_hosts.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "cli/random_id.hpp"
#include "cli/words/version.hpp"
#include "core/text/printable.hpp"

namespace rubicon::cli {

namespace {

constexpr duration swarm_goodbye_max = 5s;
constexpr duration swarm_news_every = 50ms;
constexpr duration swarm_retry_every = 1s;

child_end end_of(deploy::seed_result& x) {
  return {x.status, x.signal, std::move(x.out), std::move(x.err), x.overlong};
}

} // namespace

swarm_hosts::swarm_hosts(io::loop& where, control::system& actors,
                         const std::vector<deployed_host>& hosts, deploy::bundle what,
                         duration timeout, swarm& seeds, swarm_output& out)
    : loop_(where), experiment_(random_id()), what_(std::move(what)), timeout_(timeout),
      seeds_(seeds), out_(out) {
  for (const auto& host : hosts) {
    auto& x = hosts_.emplace_back();
    x.name = host.name;
    x.client = std::make_unique<control::client>(actors, where, host.address, host.port,
                                                 host.certificate_name());
  }
}

bool swarm_hosts::refused() const {
  return std::ranges::all_of(hosts_, [](const auto& x) { return x.at == phase::unfit; });
}

bool swarm_hosts::step() {
  for (auto& each : hosts_)
    if (!each.client->is_asking() && each.at != phase::unfit && steady::now() >= each.asks_at)
      ask(each);
  out_.draw_progress();
  return seeds_.finished() < seeds_.count() && !refused();
}

void swarm_hosts::ask(seed_host& x) {
  deploy::question what;
  if (x.at == phase::greeting)
    what = deploy::greeting{version};
  else if (x.at == phase::offer)
    what = deploy::offer_seeds{experiment_, what_, timeout_};
  else
    what = deploy::run_seeds{experiment_, seeds_for(x), x.after, is_ending_};
  const auto patience = deploy::patience_for(what);
  x.client->ask(std::move(what), patience,
                [this, &x](std::variant<deploy::answer, std::string> found) {
                  if (const auto* why = std::get_if<std::string>(&found))
                    take_back(x, *why, phase::greeting);
                  else
                    on_answer(x, std::get<deploy::answer>(found));
                });
}

void swarm_hosts::on_answer(seed_host& x, deploy::answer& found) {
  if (auto* news = std::get_if<deploy::seeds_news>(&found))
    return on_news(x, *news);
  if (const auto* theirs = std::get_if<deploy::greeting>(&found)) {
    if (theirs->version == version)
      x.at = phase::offer;
    else
      take_back(x, "runs rubicon " + theirs->version + ", this is " + version, phase::unfit);
    return;
  }
  const auto& problems = std::get<deploy::verdict>(found).problems;
  if (!problems.empty())
    return take_back(x, problems.front(), phase::unfit);
  if (!std::exchange(x.trouble, {}).empty())
    say(x, "runs seeds again");
  x.at = phase::running;
  x.after = 0;
}

void swarm_hosts::on_news(seed_host& x, deploy::seeds_news& news) {
  if (is_ending_)
    return;
  if (!news.problems.empty())
    return take_back(x, news.problems.front(), phase::offer);
  x.after = news.upto;
  x.jobs = news.jobs;
  x.finished = news.results.size();
  x.asks_at = steady::now() + swarm_news_every;
  for (auto& each : news.results) {
    if (x.given.erase(each.seed) == 0)
      continue; // it was given to another one meanwhile
    if (auto outcome = judge(each.seed, end_of(each), each.real, each.overran))
      out_.add(seeds_.ended(*std::move(outcome)));
    else
      returned_.push_front(each.seed); // its computer is shut down
  }
  std::uint64_t jobs = 0;
  for (const auto& each : hosts_)
    jobs += each.jobs;
  out_.words().jobs = jobs;
}

/// So many that a host has no idle core until it is asked again, and no more: another one may be
/// faster.
std::vector<std::uint64_t> swarm_hosts::seeds_for(seed_host& x) {
  std::vector<std::uint64_t> out;
  const auto wanted = 2 * std::max<std::size_t>(x.jobs, 1) + 2 * x.finished;
  while (!is_ending_ && x.given.size() < wanted) {
    std::optional<std::uint64_t> seed;
    if (returned_.empty()) {
      seed = seeds_.next();
    } else {
      seed = returned_.front();
      returned_.pop_front();
    }
    if (!seed)
      break;
    x.given.insert(*seed);
    out.push_back(*seed);
  }
  return out;
}

void swarm_hosts::take_back(seed_host& x, const std::string& why, phase next) {
  if (x.trouble.empty() && !is_ending_)
    say(x, why + (x.given.empty() ? ""
                                  : "; " + std::to_string(x.given.size()) +
                                        " seeds of it are given to others"));
  x.trouble = why;
  x.at = next;
  x.asks_at = steady::now() + swarm_retry_every;
  x.finished = 0;
  returned_.insert(returned_.begin(), x.given.begin(), x.given.end());
  std::ranges::sort(returned_);
  x.given.clear();
}

void swarm_hosts::end() {
  is_ending_ = true;
  const auto until = steady::now() + swarm_goodbye_max;
  std::set<const seed_host*> asked;
  const auto is_open = [&](const seed_host& x) {
    return x.at == phase::running && (x.client->is_asking() || !asked.contains(&x));
  };
  while (std::ranges::any_of(hosts_, is_open) && steady::now() < until) {
    for (auto& each : hosts_)
      if (each.at == phase::running && !each.client->is_asking() && asked.insert(&each).second)
        ask(each);
    loop_.wait_until(steady::now() + swarm_news_every);
  }
}

void swarm_hosts::say(const seed_host& x, const std::string& text) {
  out_.erase_progress();
  static_cast<void>(print(stderr, printable(x.name + "  " + text) + '\n'));
}

} // namespace rubicon::cli
