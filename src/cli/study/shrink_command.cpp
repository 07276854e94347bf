#include "cli/study/shrink_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "cli/print/swarm_text.hpp"
#include "cli/run/child_runs.hpp"
#include "cli/swarm.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"
#include "io/files/replace_file.hpp"
#include "report/expect/expectations.hpp"
#include "report/figures.hpp"
#include "study/outline.hpp"
#include "study/shrink.hpp"

namespace rubicon::cli {

namespace {

std::uint64_t whole_seconds(duration x) {
  return static_cast<std::uint64_t>(
      std::max<std::int64_t>(0, std::chrono::ceil<std::chrono::seconds>(x).count()));
}

/// A file beside FILE, as it names others relative to its folder; gone with this object.
class trial_file {
public:
  explicit trial_file(const std::filesystem::path& of)
      : path_(of.parent_path() /
              ("." + of.stem().string() + ".shrink-" + std::to_string(::getpid()) + ".toml")) {}
  ~trial_file() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  trial_file(const trial_file&) = delete;
  trial_file& operator=(const trial_file&) = delete;

  /// @returns why not; empty: it is there
  [[nodiscard]] std::string write(const std::string& text) const {
    return io::replace_file(path_.string(), text);
  }
  [[nodiscard]] std::string path() const { return path_.string(); }

private:
  std::filesystem::path path_;
};

/// Runs versions of the file, one after the other.
class trials {
public:
  explicit trials(const shrink_command& x) : command_(x), file_(x.file), runs_(x.timeout) {}

  /// What became of the run; nothing if it was interrupted, or the file cannot be written.
  [[nodiscard]] std::optional<seed_outcome> run(const std::string& text) {
    problem_ = file_.write(text);
    if (!problem_.empty())
      return std::nullopt;
    return finish(run_words(file_.path(), command_.seed, {}, command_.settings));
  }

  /// Runs a file once more for its record.
  void record(const std::string& file, const std::string& to) {
    auto words = run_words(file, command_.seed, {}, command_.settings);
    words.insert(words.end(), {"--record", to});
    static_cast<void>(finish(words));
  }

  [[nodiscard]] const std::string& problem() const { return problem_; }

  /// What a report says of a version, of `file` instead.
  [[nodiscard]] std::string named(std::string text, const std::string& file) const {
    for (auto at = text.find(file_.path()); at != std::string::npos;
         at = text.find(file_.path(), at + file.size()))
      text.replace(at, file_.path().size(), file);
    return text;
  }

private:
  std::optional<seed_outcome> finish(const std::vector<std::string>& words) {
    runs_.start(0, words);
    while (!runs_.interrupted())
      for (const auto& each : runs_.wait(1min))
        return judge(command_.seed, each.how, each.real, each.overran);
    return std::nullopt;
  }

  const shrink_command& command_;
  trial_file file_;
  child_runs runs_;
  std::string problem_;
};

/// The first by time.
std::optional<report::violation> first_of(const seed_outcome& x) {
  const auto first = std::ranges::min_element(x.violations, {}, &report::violation::at);
  return first == x.violations.end() ? std::nullopt : std::optional(*first);
}

std::string kept_text(const char* what, study::kept x) {
  return x.of == 0 ? std::string()
                   : std::string(", ") + std::to_string(x.left) + " of " + std::to_string(x.of) +
                         ' ' + what;
}

/// `home.small.toml` of `home.toml`
std::string out_of(const shrink_command& x) {
  const std::filesystem::path path(x.file);
  return x.out.empty() ? (path.parent_path() / (path.stem().string() + ".small.toml")).string()
                       : x.out;
}

std::string record_beside(const std::string& file) {
  return std::filesystem::path(file).replace_extension(".rec").string();
}

std::string summary_of(const shrink_command& x, const study::shrinker& found,
                       const report::violation& what, const std::string& file) {
  const auto text = found.smallest();
  const auto entries = study::outline_of(text);
  const bool from_wall =
      std::ranges::find(entries, "ecology.mode", &study::piece::path) != entries.end();
  const swarm_words words{.file = file, .from_wall = from_wall, .settings = x.settings};
  return "violation: " + printable(what.invariant) + ": " + printable(what.detail) + '\n' +
         printable(file) + ": " +
         report::counted(static_cast<std::uint64_t>(std::ranges::count(text, '\n')), "line") +
         kept_text("faults and changes", found.faults()) +
         kept_text("motes and other tables of islands", found.motes()) +
         kept_text("peers and their tables", found.peers()) + ", after " +
         report::counted(found.tries(), "run") + '\n' + replay_command(words, x.seed) +
         "\nrubicon explain " + shell_word(record_beside(file)) + '\n';
}

std::optional<std::string> text_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return in ? std::optional(std::move(text).str()) : std::nullopt;
}

/// Tries all. @returns whether it was interrupted
bool shrink(study::shrinker& to, trials& runs, report::violation& what) {
  for (auto text = to.next(); text; text = to.next()) {
    const auto outcome = runs.run(*text);
    if (!outcome)
      return true;
    const auto same = std::ranges::find_if(outcome->violations,
                                           [&](const auto& each) { return is_same(each, what); });
    to.take(same != outcome->violations.end());
    if (same != outcome->violations.end())
      what = *same;
  }
  return false;
}

} // namespace

std::string subject_of_violation(std::string_view invariant, std::string_view detail) {
  if (invariant.starts_with(report::expected))
    return {};
  const auto before = detail.substr(0, detail.find(':'));
  if (std::ranges::count(before, ' ') <= 1) // `island 3: not listed 7`
    return std::string(before);
  return std::string(detail.substr(0, detail.find(' ')));
}

bool is_same(const report::violation& x, const report::violation& y) {
  return x.invariant == y.invariant &&
         subject_of_violation(x.invariant, x.detail) == subject_of_violation(y.invariant, y.detail);
}

exit_status perform(const shrink_command& x) {
  config::overrides instead;
  instead.seed = x.seed;
  instead.mode = config::run_mode::virtual_time;
  instead.settings = x.settings;
  const auto file = load_or_complain(x.file, instead, x.known);
  if (!file)
    return exit_status::refused;
  const auto text = text_of_file(x.file);
  if (!text)
    return refuse(x.file + " cannot be read");
  trials runs(x);
  const auto whole = runs.run(*text);
  if (!whole)
    return runs.problem().empty() ? exit_status::interrupted : refuse(runs.problem());
  auto what = first_of(*whole);
  if (!what)
    return refuse("seed " + std::to_string(x.seed) + " has no violation");
  study::shrinker smaller(*text, whole_seconds(file->ecology.length),
                          whole_seconds(what->at - instant{}));
  const bool interrupted = shrink(smaller, runs, *what);
  const auto out = out_of(x);
  if (const auto why = io::replace_file(out, smaller.smallest()); !why.empty())
    return refuse(why);
  what->detail = runs.named(std::move(what->detail), out);
  if (!interrupted)
    runs.record(out, record_beside(out));
  if (!print(stdout, summary_of(x, smaller, *what, out)))
    return exit_status::refused;
  return interrupted ? exit_status::interrupted : exit_status::good;
}

} // namespace rubicon::cli
