#include "cli/study/when_command.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "cli/record/read_record.hpp"
#include "cli/run/child_runs.hpp"
#include "cli/study/shrink_command.hpp"
#include "cli/study/when_text.hpp"
#include "cli/swarm.hpp"
#include "cli/words/option_text.hpp"
#include "core/hash.hpp"

namespace rubicon::cli {

namespace {

/// The option and its value in the words of a command line; those of flags are never asked for.
template <class Take>
void for_each_option(const std::vector<std::string>& words, Take take) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i].starts_with("--"))
      take(words[i], words[i + 1]);
}

/// Why the run of a record cannot be repeated; empty: it can.
std::string why_not_repeated(const explain::header& x) {
  if (x.wall)
    return "was written in wall time, where no run can be repeated";
  if (x.length <= 0s)
    return "does not say how long the run was: record it again";
  if (x.file.empty() || x.file == standard_input)
    return "names no file that can be read again";
  if (std::ranges::find(x.options, "--reseed") != x.options.end())
    return "is of a run with --reseed: record the run without it";
  return {};
}

/// What the run of a record replaced in its file.
config::overrides overrides_of(const explain::header& x) {
  config::overrides instead;
  instead.seed = x.seed;
  instead.mode = config::run_mode::virtual_time;
  for_each_option(x.options, [&](const auto& option, const auto& value) {
    if (option == "--set")
      instead.settings.push_back(value);
    else if (option == "--topology")
      instead.topology = value;
    else if (option == "--noise-trace")
      instead.noise_trace = value;
  });
  return instead;
}

/// Of its options those that a virtual run has.
std::vector<std::string> options_of(const explain::header& x) {
  auto words = x.options;
  for (const auto* each : {"--mode", "--speed"})
    if (const auto found = std::ranges::find(words, each); found != words.end())
      words.erase(found, std::min(found + 2, words.end()));
  return words;
}

std::string violation_text(const report::violation& x) {
  return x.invariant + ": " + x.detail;
}

/// Runs of the record's ecology, as many at a time as there may be.
class repeated_runs {
public:
  repeated_runs(const when_command& x, const explain::header& about)
      : jobs_(std::max<std::uint64_t>(1, x.jobs.value_or(std::thread::hardware_concurrency()))),
        futures_(x.futures), seed_(about.seed),
        words_(run_words(about.file, about.seed, option_text(about.length))), runs_(x.timeout) {
    const auto options = options_of(about);
    words_.insert(words_.end(), options.begin(), options.end());
  }

  /// The run itself; nothing: it was interrupted, or problem() says why.
  [[nodiscard]] std::optional<seed_outcome> repeat() {
    runs_.start(0, words_);
    while (!runs_.interrupted())
      if (const auto ended = runs_.wait(1min); !ended.empty())
        return judged(ended.front());
    return std::nullopt;
  }

  /// Nothing: the same.
  [[nodiscard]] std::optional<study::future_count> count(const study::turning_point::question& x,
                                                         const report::violation& what) {
    study::future_count sum{x.at, 0, 0, std::nullopt};
    std::uint64_t begun = 0;
    while (sum.of < futures_) {
      for (; begun < futures_ && runs_.size() < jobs_; ++begun)
        start(x.at, begun + 1);
      for (const auto& each : runs_.wait(1min))
        if (!add(sum, each, what))
          return std::nullopt;
      if (runs_.interrupted())
        return std::nullopt;
      if (!x.counts_all && !sum.all())
        break;
    }
    runs_.kill_all();
    return sum;
  }

  /// Of a run without a report, which is neither with nor without the violation; empty: none.
  [[nodiscard]] const std::string& problem() const { return problem_; }

private:
  void start(duration at, std::uint64_t key) {
    auto words = words_;
    words.insert(words.end(), {"--reseed", reseed_text(at, key)});
    runs_.start(key, words);
  }

  std::optional<seed_outcome> judged(const child_runs::ended_run& x) {
    auto out = judge(seed_, x.how, x.real, x.overran);
    if (!out || !out->figures.empty())
      return out;
    problem_ = violation_text(out->violations.front());
    return std::nullopt;
  }

  /// @returns false: it says nothing
  bool add(study::future_count& sum, const child_runs::ended_run& x,
           const report::violation& what) {
    const auto found = judged(x);
    if (!found)
      return false;
    ++sum.of;
    if (std::ranges::any_of(found->violations,
                            [&](const auto& each) { return is_same(each, what); }))
      ++sum.with;
    else
      sum.without = std::min(sum.without.value_or(x.id), x.id);
    return true;
  }

  const std::uint64_t jobs_;
  const std::size_t futures_;
  const std::uint64_t seed_;
  std::vector<std::string> words_;
  child_runs runs_;
  std::string problem_;
};

/// The first by time that has the words; of all without words. Else what there is.
std::variant<report::violation, std::string> chosen_violation(std::vector<report::violation> all,
                                                              const std::string& words) {
  if (all.empty())
    return "its run has no violation";
  std::ranges::stable_sort(all, {}, &report::violation::at);
  const auto found = std::ranges::find_if(
      all, [&](const auto& each) { return violation_text(each).find(words) != std::string::npos; });
  if (found != all.end())
    return *found;
  std::string known;
  for (const auto& each : all)
    known += (known.empty() ? "" : "; ") + violation_text(each);
  return "no violation has `" + words + "` in its text; there is: " + known;
}

/// Of the command that repeats it, for people.
std::vector<std::string> replay_words(const explain::header& x) {
  std::vector<std::string> words{x.file};
  const auto options = options_of(x);
  words.insert(words.end(), options.begin(), options.end());
  words.insert(words.end(), {"--seed", std::to_string(x.seed), "--for", option_text(x.length)});
  return words;
}

/// @returns false: a run said nothing
bool find_turn(when_answer& to, repeated_runs& runs) {
  while (const auto next = to.found.next()) {
    const auto count = runs.count(*next, to.what);
    if (!count)
      return false;
    to.found.take(*count);
  }
  return true;
}

} // namespace

exit_status perform(const when_command& x) {
  const auto recorded = read_record(x.record);
  if (const auto* why = std::get_if<std::string>(&recorded)) {
    say(*why);
    return exit_status::refused;
  }
  const auto& all = std::get<explain::traces>(recorded);
  const auto& about = all.about;
  if (const auto why = why_not_repeated(about); !why.empty())
    return refuse(x.record + ' ' + why);
  const auto file = load_or_complain(about.file, overrides_of(about), x.known);
  if (!file)
    return exit_status::refused;
  if (to_hex(file->text_hash) != about.digest)
    return refuse(about.file + " has changed since " + x.record +
                  " was written: record the run again");
  repeated_runs runs(x, about);
  const auto stopped = [&] {
    return runs.problem().empty() ? exit_status::interrupted
                                  : refuse(x.record + ": " + runs.problem());
  };
  const auto whole = runs.repeat();
  if (!whole)
    return stopped();
  const auto found = chosen_violation(whole->violations, x.what);
  if (const auto* why = std::get_if<std::string>(&found))
    return refuse(x.record + ": " + *why);
  const auto& what = std::get<report::violation>(found);
  when_answer answer{what, x.futures,
                     study::turning_point(what.at.time_since_epoch(), about.length, x.within),
                     replay_words(about)};
  if (!find_turn(answer, runs))
    return stopped();
  const auto output = console_of(stdout);
  const explain::text_style style{output.width, output.colour, output.room()};
  return print(stdout, x.json ? when_json(answer, all) : when_text(answer, all, style))
             ? exit_status::good
             : exit_status::refused;
}

} // namespace rubicon::cli
