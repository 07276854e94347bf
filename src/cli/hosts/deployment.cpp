#include "cli/hosts/deployment.hpp"

#include <algorithm>
#include <utility>

#include "cli/print/progress_bar.hpp"
#include "cli/words/version.hpp"
#include "config/summary_parts.hpp"
#include "core/text/printable.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

constexpr duration news_every = 200ms; ///< from an answer to the next question
constexpr duration retry_early = 50ms; ///< while nothing has begun
constexpr duration retry_every = 1s;   ///< later
constexpr duration goodbye_max = 10s;  ///< for reports, once all is over
constexpr duration restart_least = 1s; ///< so much must be left for a part to begin again

} // namespace

deployment::deployment(io::loop& loop, control::system& actors, std::string id, deploy::packed file,
                       const std::vector<deployed_host>& hosts, deployment_options options)
    : id_(std::move(id)), what_(std::move(file.what)), secrets_(file.loaded.seen.secrets),
      ecology_(*std::move(file.loaded.ecology)), options_(std::move(options)) {
  for (const auto& host : hosts) {
    auto& x = hosts_.emplace_back();
    x.name = host.name;
    x.report.host = host.name;
    x.client = std::make_unique<control::client>(actors, loop, host.address, host.port,
                                                 host.certificate_name());
  }
}

deployment::~deployment() {
  erase_progress();
}

duration deployment::elapsed() const {
  return began_ ? duration(steady::now() - *began_) : duration{};
}

bool deployment::is_late() const {
  if (stopping_)
    return steady::now() >= *stopping_ + goodbye_max;
  return began_ && elapsed() >= ecology_.length + goodbye_max;
}

bool deployment::step() {
  const auto now = steady::now();
  if (!began_ && !stopping_ && std::ranges::all_of(hosts_, [](const followed& x) {
        return x.at == phase::ready || x.at == phase::following;
      }))
    began_ = now;
  for (auto& each : hosts_)
    if (!each.client->is_asking() && now >= each.asks_at)
      ask(each);
  draw_progress();
  const bool all_ended =
      std::ranges::all_of(hosts_, [](const followed& x) { return x.at == phase::ended; });
  const bool never_begun = stopping_ && !began_;
  return !all_ended && !never_begun && !is_late();
}

void deployment::stop(bool interrupted) {
  if (stopping_)
    return;
  stopping_ = steady::now();
  interrupted_ = interrupted;
}

void deployment::cause(const std::string& sentence) {
  for (auto& each : hosts_) {
    if (each.at != phase::following) {
      say(each, "is not reachable and did not receive `" + sentence + '`');
      continue;
    }
    each.faults.push_back(sentence);
    each.asks_at = steady::now();
  }
}

deploy::bundle deployment::part_for(const followed& x) const {
  return deploy::part_of(what_, ecology_, secrets_, x.name);
}

void deployment::ask(followed& x) {
  switch (x.at) {
  case phase::greeting:
    return ask(x, deploy::greeting{version}, &deployment::on_greeting);
  case phase::facts:
    return ask(x, deploy::ask_facts{}, &deployment::on_facts);
  case phase::offer:
    return ask(x, deploy::offer{id_, x.name, part_for(x), options_.log_level, false},
               &deployment::on_offer);
  case phase::ready:
    if (began_)
      ask(x, deploy::begin_part{id_, elapsed()}, &deployment::on_begun);
    return;
  case phase::following:
    if (stopping_ && !x.end_requested)
      return ask(x, deploy::end_part{id_}, &deployment::on_end_requested);
    if (!x.faults.empty())
      return ask(x, deploy::cause_fault{id_, x.faults.front()}, &deployment::on_caused);
    return ask(x, deploy::ask_news{id_, x.line, x.change}, &deployment::on_news);
  case phase::ended:
    return;
  }
}

void deployment::ask(followed& x, deploy::question what,
                     void (deployment::*then)(followed&, deploy::answer&)) {
  const auto patience = deploy::patience_for(what);
  x.client->ask(std::move(what), patience,
                [this, &x, then](std::variant<deploy::answer, std::string> found) {
                  if (const auto* why = std::get_if<std::string>(&found))
                    return on_silence(x, *why);
                  if (!std::exchange(x.trouble, {}).empty() && began_)
                    say(x, "answers again");
                  (this->*then)(x, std::get<deploy::answer>(found));
                });
}

void deployment::on_silence(followed& x, const std::string& why) {
  x.asks_at = steady::now() + (began_ ? retry_every : retry_early);
  if (x.at != phase::ended)
    x.at = phase::greeting;
  for (const auto& sentence : std::exchange(x.faults, {})) // a fault that comes late is another one
    say(x, "may not have received `" + sentence + '`');
  if (began_) {
    if (x.trouble.empty())
      say(x, why);
  } else if (steady::now() >= made_ + options_.patience) {
    fail(x, why + ": start `rubicon host --name " + x.name + "` at " + x.client->place());
  }
  x.trouble = why;
}

void deployment::on_greeting(followed& x, deploy::answer& found) {
  const auto& theirs = std::get<deploy::greeting>(found).version;
  if (theirs == version)
    x.at = phase::facts;
  else
    fail(x, "runs rubicon " + theirs + ", this is " + version + ": install the same on both");
}

void deployment::on_facts(followed& x, deploy::answer& found) {
  x.facts = std::get<deploy::host_facts>(std::move(found));
  const auto& facts = x.facts;
  if (facts.host != x.name)
    return fail(x, "at " + x.client->place() + " has the name `" + facts.host + '`');
  if (options_.attach && !began_ && !take_over(x))
    return;
  const bool has_it = facts.deployment == id_;
  if (has_it && facts.state != deploy::part_state::offered) {
    x.at = phase::following;
    return;
  }
  if (began_ && elapsed() + restart_least >= ecology_.length) {
    x.at = phase::ended; // too late to begin again
    return;
  }
  if (stopping_)
    x.at = phase::ended;
  else
    x.at = phase::offer;
}

/// Finds out what runs there. @returns false if it is not what we follow
bool deployment::take_over(followed& x) {
  const auto& facts = x.facts;
  if (facts.deployment.empty() || facts.state == deploy::part_state::offered) {
    x.asks_at = steady::now() + retry_early; // another host may know it
    if (x.asks_at >= made_ + options_.patience)
      fail(x, "runs no part: deploy the file without --attach");
    return false;
  }
  if (facts.files_hash != hash_of(part_for(x))) {
    fail(x, "runs `" + facts.ecology + "` from another file or an older version of it");
    return false;
  }
  id_ = facts.deployment;
  what_.seed = facts.seed;
  what_.length = facts.length;
  ecology_.seed = facts.seed;
  ecology_.length = facts.length;
  began_ = steady::now() - facts.elapsed;
  return true;
}

void deployment::on_offer(followed& x, deploy::answer& found) {
  const auto& said = std::get<deploy::verdict>(found);
  if (said.problems.empty())
    x.at = phase::ready;
  else
    fail(x, config::joined(said.problems, "; "));
}

void deployment::on_begun(followed& x, deploy::answer& found) {
  const auto& said = std::get<deploy::verdict>(found);
  x.at = said.problems.empty() ? phase::following : phase::facts;
  x.line = 0;
  x.change = 0;
  if (!said.problems.empty())
    fail(x, config::joined(said.problems, "; "));
}

void deployment::on_end_requested(followed& x, deploy::answer& /*found*/) {
  x.end_requested = true;
}

void deployment::on_caused(followed& x, deploy::answer& found) {
  for (const auto& why : std::get<deploy::verdict>(found).problems)
    say(x, x.faults.front() + ": " + why);
  x.faults.pop_front();
}

void deployment::on_news(followed& x, deploy::answer& found) {
  auto& news = std::get<deploy::news>(found);
  x.facts = std::move(news.facts);
  x.asks_at = steady::now() + news_every;
  if (x.facts.deployment != id_) { // its service was started again
    x.at = phase::facts;
    return;
  }
  if (x.line > 0 || !options_.attach) { // what was written before has been read before
    if (news.lines_left_out > 0)
      say(x, '(' + std::to_string(news.lines_left_out) + " lines are left out)");
    for (const auto& line : news.lines)
      say(x, line);
  }
  x.line = news.line;
  x.change = news.change;
  for (auto& each : news.lives)
    take(x, each);
  if (news.has_more) {
    x.asks_at = steady::now();
  } else if (x.facts.state == deploy::part_state::ended) {
    x.at = phase::ended;
    if (x.facts.refused) {
      refused_ = true;
      stop(/*interrupted=*/false);
    }
  }
}

void deployment::take(followed& x, deploy::life_news& from) {
  const auto found = std::ranges::find(x.lives, from.life);
  const auto number = static_cast<std::size_t>(found - x.lives.begin());
  if (found == x.lives.end()) {
    x.lives.push_back(from.life);
    x.report.lives.emplace_back();
  }
  auto& life = x.report.lives[number];
  life.elapsed = from.elapsed;
  life.ended = from.ended;
  life.is_final = from.is_final;
  life.newest = std::move(from.newest);
}

/// What cannot be mended by waiting ends what has not begun; later, the others go on.
void deployment::fail(followed& x, const std::string& why) {
  if (x.trouble != why)
    say(x, why);
  x.trouble = why;
  x.at = phase::greeting;
  x.asks_at = steady::now() + retry_every;
  if (!began_) {
    refused_ = true;
    stop(/*interrupted=*/false);
  }
}

void deployment::say(const followed& x, const std::string& text) {
  if (!options_.prints_lines && began_)
    return;
  erase_progress();
  static_cast<void>(print(stderr, printable(x.name + "  " + text) + '\n'));
}

std::string deployment::progress_of(const followed& x) const {
  if (!x.trouble.empty())
    return x.name + "  " + x.trouble;
  if (!began_)
    return x.name + (x.at == phase::ready ? "  ready" : "  is asked");
  return x.name + "  " + to_string(x.facts.state) + "  " + report::clock_text(x.facts.elapsed) +
         " of " + report::clock_text(ecology_.length) + ", process " +
         std::to_string(x.facts.lives) + ", " + std::to_string(x.facts.memory >> 20) + " MiB";
}

void deployment::draw_progress() {
  const auto now = steady::now();
  if (!errors_.is_terminal || now < made_ + progress_bar::shown_after ||
      now < drawn_at_ + progress_bar::redrawn_every)
    return;
  erase_progress();
  drawn_at_ = now;
  std::string text;
  for (const auto& each : hosts_)
    text += report::cut(printable(progress_of(each)), errors_.width - 1) + '\n';
  lines_drawn_ = hosts_.size();
  static_cast<void>(print(stderr, text));
}

void deployment::erase_progress() {
  if (const auto lines = std::exchange(lines_drawn_, 0); lines > 0)
    static_cast<void>(print(stderr, "\033[" + std::to_string(lines) + "A\033[J"));
}

report::run_report deployment::whole_report() const {
  std::vector<report::host_report> all;
  bool is_cut_short = interrupted_; // by us, or by somebody else's `rubicon stop`
  for (const auto& each : hosts_) {
    all.push_back(each.report);
    is_cut_short = is_cut_short || (!each.report.lives.empty() &&
                                    each.report.lives.back().newest.report.interrupted);
  }
  auto whole = report::merged(ecology_, all);
  whole.interrupted = is_cut_short;
  return whole;
}

} // namespace rubicon::cli
