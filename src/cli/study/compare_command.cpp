#include "cli/study/compare_command.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <unistd.h>

#include "cli/ecology_file.hpp"
#include "cli/own_binary.hpp"
#include "cli/print/console.hpp"
#include "cli/study/compare_records.hpp"
#include "cli/study/compare_text.hpp"
#include "cli/study/result_runs.hpp"
#include "cli/swarm.hpp"
#include "report/figures.hpp"
#include "study/comparison.hpp"
#include "study/store.hpp"

namespace rubicon::cli {

namespace {

using side = study::figure_pairs::side;

constexpr std::uint64_t seeds_max = study::figure_pairs::runs_max;

enum class subject : std::uint8_t { nothing, file, binary, study, record };

std::string_view to_string(subject x) {
  switch (x) {
  case subject::nothing:
    return "nothing that can be read";
  case subject::file:
    return "a file of an ecology";
  case subject::binary:
    return "a binary";
  case subject::study:
    return "the database of a study";
  case subject::record:
    return "a record";
  }
  return {};
}

/// By how it begins.
subject subject_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string begin(64, '\0');
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(in.gcount()));
  if (begin.empty())
    return subject::nothing;
  if (begin.starts_with("\x7f"
                        "ELF") ||
      (begin.starts_with("#!") && ::access(path.c_str(), X_OK) == 0))
    return subject::binary;
  if (begin.starts_with("SQLite format 3"))
    return subject::study;
  return begin.starts_with("{\"rubicon_record\"") ? subject::record : subject::file;
}

/// Only what is compared.
std::map<std::string, double> chosen(const compare_command& x, std::map<std::string, double> all) {
  std::erase_if(all, [&](const auto& each) {
    return x.scalars.empty() ? each.first == "wall_s"
                             : std::ranges::find(x.scalars, each.first) == x.scalars.end();
  });
  return all;
}

/// Each seed with both sides, one after the other.
class compared_runs : public result_plan {
public:
  explicit compared_runs(const compare_command& x, subject what) : command_(x), what_(what) {}

  [[nodiscard]] std::optional<result_job> next() override {
    if (next_ == expected())
      return std::nullopt;
    const auto n = next_++;
    const auto seed = seed_of(n);
    const auto& mine = side_of(n) == side::a ? command_.a : command_.b;
    const bool is_binary = what_ == subject::binary;
    return result_job{
        mine + ", seed " + std::to_string(seed), seed,
        run_words(is_binary ? command_.file : mine, seed, command_.length, command_.settings),
        is_binary ? mine : own_binary};
  }

  void take(std::size_t n, std::optional<study::run_result> x) override {
    if (x)
      pairs_.add(side_of(n), {}, seed_of(n), chosen(command_, std::move(x->scalars)));
  }

  [[nodiscard]] std::size_t expected() const override {
    return 2 * (command_.seeds.last - command_.seeds.first + 1);
  }

  [[nodiscard]] const study::figure_pairs& pairs() const { return pairs_; }

private:
  [[nodiscard]] std::uint64_t seed_of(std::size_t n) const { return command_.seeds.first + n / 2; }
  [[nodiscard]] static side side_of(std::size_t n) { return n % 2 == 0 ? side::a : side::b; }

  const compare_command& command_;
  subject what_;
  std::size_t next_ = 0;
  study::figure_pairs pairs_;
};

/// @returns violated if anything surely differs
exit_status show(const compare_command& x, const study::figure_pairs& pairs) {
  if (pairs.pairs() == 0)
    return cli::refuse("there are no two runs of one variant and seed to compare");
  const shown_comparison all{x.a, x.b, pairs.pairs(), pairs.single(), study::compare(pairs.all())};
  if (pairs.left_out() > 0)
    say(report::counted(pairs.left_out(), "run") + " left out: the first " +
        std::to_string(study::figure_pairs::runs_max) + " are compared");
  const auto out = console_of(stdout);
  if (!print(stdout, x.csv ? comparison_csv(all.found)
                           : comparison_text(all, x.full, out.room(), out.colour)))
    return exit_status::refused;
  return all.found.sure > 0 ? exit_status::violated : exit_status::good;
}

/// Whether a file can be run; else what is wrong is printed.
bool is_valid(const compare_command& x, const std::string& file) {
  config::overrides instead;
  instead.seed = x.seeds.first;
  instead.mode = config::run_mode::virtual_time;
  instead.settings = x.settings;
  return load_or_complain(file, instead, x.known).has_value();
}

exit_status run_both(const compare_command& x, subject what) {
  if (x.seeds.last - x.seeds.first >= seeds_max)
    return cli::refuse("more than " + std::to_string(seeds_max) + " seeds");
  if (what == subject::binary && x.file.empty())
    return cli::refuse("two binaries need a file that both run: --file FILE");
  if (what == subject::file && (!is_valid(x, x.a) || !is_valid(x, x.b)))
    return exit_status::refused;
  compared_runs runs(x, what);
  const auto status = result_runs(x.jobs, x.timeout).run_all(runs);
  if (status == exit_status::interrupted)
    return status;
  if (status == exit_status::failed && runs.pairs().pairs() == 0)
    return status;
  return std::max(status, show(x, runs.pairs()));
}

std::string label_of(study::run_parameters parameters) {
  std::ranges::sort(parameters);
  std::string label;
  for (const auto& [path, value] : parameters)
    label += (label.empty() ? "" : " ") + path + '=' + value;
  return label;
}

/// @returns why not
std::optional<std::string> add_study(const compare_command& x, const std::string& path, side where,
                                     study::figure_pairs& to) {
  auto opened = study::store::open(path, study::store::access::read);
  if (const auto* why = std::get_if<std::string>(&opened))
    return path + ' ' + *why;
  auto& store = std::get<study::store>(opened);
  store.for_each_run([&](const study::run_result& run) {
    to.add(where, label_of(run.parameters), run.seed, chosen(x, run.scalars));
  });
  return std::nullopt;
}

exit_status compare_studies(const compare_command& x) {
  study::figure_pairs pairs;
  for (const auto& [path, where] : {std::pair(x.a, side::a), std::pair(x.b, side::b)})
    if (const auto why = add_study(x, path, where, pairs))
      return cli::refuse(*why);
  return show(x, pairs);
}

exit_status show_parting(const compare_command& x) {
  std::ifstream a(x.a, std::ios::binary);
  std::ifstream b(x.b, std::ios::binary);
  const auto found = cli::compare_records(a, x.a, b, x.b);
  if (!found.problem.empty())
    return cli::refuse(found.problem);
  if (!print(stdout, found.text))
    return exit_status::refused;
  return found.differs ? exit_status::violated : exit_status::good;
}

} // namespace

exit_status perform(const compare_command& x) {
  const auto a = subject_of(x.a);
  const auto b = subject_of(x.b);
  for (const auto& [what, path] : {std::pair(a, x.a), std::pair(b, x.b)})
    if (what == subject::nothing)
      return cli::refuse(path + " is empty or cannot be read");
  if (a != b)
    return cli::refuse(x.a + " is " + std::string(to_string(a)) + ", and " + x.b + " is " +
                       std::string(to_string(b)));
  switch (a) {
  case subject::study:
    return compare_studies(x);
  case subject::record:
    return show_parting(x);
  case subject::file:
  case subject::binary:
  case subject::nothing:
    break;
  }
  return run_both(x, a);
}

} // namespace rubicon::cli
