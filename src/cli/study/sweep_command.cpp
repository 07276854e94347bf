#include "cli/study/sweep_command.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "cli/ecology_file.hpp"
#include "cli/own_binary.hpp"
#include "cli/print/console.hpp"
#include "cli/study/figure_text.hpp"
#include "cli/study/result_runs.hpp"
#include "cli/study/sweep_page.hpp"
#include "cli/study/sweep_text.hpp"
#include "cli/swarm.hpp"
#include "config/toml/units.hpp"
#include "core/hash.hpp"
#include "deploy/bundle.hpp"
#include "io/files/temporary_folder.hpp"
#include "report/figures.hpp"
#include "study/series.hpp"
#include "study/statistics.hpp"
#include "study/stopping.hpp"
#include "study/store.hpp"

namespace rubicon::cli {

namespace {

constexpr std::uint64_t runs_max = 1'000'000;

/// One variant: what it sets, and the keys of its runs by seed.
struct planned_variant {
  config::settings settings; ///< those of all variants first
  study::run_parameters parameters;
  std::string label; ///< `loss=0.1 range=15m`
  std::vector<std::string> keys;
  bool from_wall = false; ///< the file says wall: a replay must say virtual
};

std::string hash_of_binary() {
  std::ifstream in(own_binary, std::ios::binary);
  fold64 hash;
  std::vector<char> part(65536);
  while (in.read(part.data(), static_cast<std::streamsize>(part.size())) || in.gcount() > 0)
    hash.add(std::string_view(part.data(), static_cast<std::size_t>(in.gcount())));
  return to_hex(hash.value());
}

planned_variant variant_of(const sweep_command& x, const study::variant_values& values) {
  planned_variant out{x.settings, {}, {}, {}, false};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& path = x.variations[i].path;
    out.settings.push_back(path + '=' + values[i]);
    out.parameters.emplace_back(path, values[i]);
    out.label += (i == 0 ? "" : " ") + out.settings.back();
  }
  return out;
}

/// All variants with the keys of their runs; nothing if one is wrong, which is then printed.
std::optional<std::vector<planned_variant>>
plan_of(const sweep_command& x, const std::vector<study::variant_values>& variants) {
  const auto binary = hash_of_binary();
  std::vector<planned_variant> out;
  for (const auto& values : variants) {
    auto planned = variant_of(x, values);
    config::overrides instead;
    instead.seed = x.seeds.first;
    instead.mode = config::run_mode::virtual_time;
    instead.settings = planned.settings;
    const auto packed = deploy::pack(x.file, instead, std::nullopt, x.known);
    if (!packed.loaded.problems.empty() || !packed.loaded.ecology) {
      complain(packed.loaded, x.file);
      return std::nullopt;
    }
    planned.from_wall = packed.loaded.ecology->mode == config::run_mode::wall;
    const auto text = binary + '-' + deploy::hash_of(packed.what) + '-' + x.length + '-';
    for (auto seed = x.seeds.first;; ++seed) {
      planned.keys.push_back(text + std::to_string(seed));
      if (seed == x.seeds.last)
        break;
    }
    out.push_back(std::move(planned));
  }
  return out;
}

std::string label_of(const planned_variant& x, std::uint64_t seed) {
  return (x.label.empty() ? "" : x.label + ", ") + "seed " + std::to_string(seed);
}

std::string text_in(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

/// Of the tables in a folder (docs/data.md).
std::vector<study::series_point> series_in(const std::filesystem::path& folder) {
  const auto energy = text_in(folder / "energy.csv");
  auto all = study::summed_series(energy, "used_mah", "energy.used_mah");
  std::ranges::move(study::summed_series(energy, "alive", "motes.alive"), std::back_inserter(all));
  std::ranges::move(
      study::summed_series(text_in(folder / "losses.csv"), "lost", "losses", {"layer", "cause"}),
      std::back_inserter(all));
  return all;
}

/// Which runs are made: those that the database lacks, of each variant at first as many as the
/// first look needs, or all.
class sweep_plan : public result_plan {
public:
  sweep_plan(const sweep_command& x, const std::vector<planned_variant>& variants,
             study::store& store)
      : command_(x), variants_(variants), store_(store), states_(variants.size()) {
    if (x.until)
      looks_.emplace(*x.until, variants.front().keys.size());
    if (!x.series_every.empty())
      tables_.emplace("rubicon-sweep");
    for (std::size_t i = 0; i < variants.size(); ++i)
      look(i);
  }

  [[nodiscard]] std::optional<result_job> next() override {
    if (next_ == missing_.size())
      return std::nullopt;
    const auto [variant, number] = missing_[next_++];
    const auto seed = command_.seeds.first + number;
    auto words = run_words(command_.file, seed, command_.length, variants_[variant].settings);
    if (tables_)
      words.insert(words.end(),
                   {"--csv", folder_of(next_ - 1).string(), "--csv-every", command_.series_every});
    return result_job{label_of(variants_[variant], seed), seed, std::move(words)};
  }

  void take(std::size_t n, std::optional<study::run_result> x) override {
    const auto [variant, number] = missing_[n];
    if (x) {
      x->key = variants_[variant].keys[number];
      x->file = command_.file;
      x->parameters = variants_[variant].parameters;
      if (tables_)
        x->series = series_in(folder_of(n));
      store_.add(*x);
    }
    std::error_code ignored;
    if (tables_)
      std::filesystem::remove_all(folder_of(n), ignored);
    if (--states_[variant].in_progress == 0)
      look(variant);
  }

  [[nodiscard]] std::size_t expected() const override { return missing_.size(); }

  /// Keys of the runs that a variant was given.
  [[nodiscard]] std::vector<std::string> keys_of(std::size_t variant) const {
    const auto& keys = variants_[variant].keys;
    const auto runs = static_cast<std::ptrdiff_t>(states_[variant].runs);
    return {keys.begin(), keys.begin() + runs};
  }

  /// What is shown of the looks; nothing without `--until`.
  [[nodiscard]] const std::optional<study::stopping>& looks() const { return looks_; }

private:
  struct state {
    std::size_t runs = 0; ///< that it has been given
    std::size_t in_progress = 0;
  };

  /// Where the run that next() gave as the n-th writes its tables. @pre tables_
  [[nodiscard]] std::filesystem::path folder_of(std::size_t n) const {
    return tables_->path() / std::to_string(n);
  }

  [[nodiscard]] std::size_t needed(std::size_t variant) {
    const auto keys = keys_of(variant);
    return looks_ ? looks_->needed(store_.values(keys, command_.until->figure))
                  : variants_[variant].keys.size();
  }

  /// Gives a variant more runs until it has enough, or waits for some.
  void look(std::size_t variant) {
    auto& x = states_[variant];
    for (auto runs = needed(variant); runs > x.runs && x.in_progress == 0; runs = needed(variant)) {
      for (; x.runs < runs; ++x.runs) {
        const auto& key = variants_[variant].keys[x.runs];
        if (store_.has(key)) {
          store_.add_parameters(key, variants_[variant].parameters);
        } else {
          missing_.emplace_back(variant, x.runs);
          ++x.in_progress;
        }
      }
    }
  }

  const sweep_command& command_;
  const std::vector<planned_variant>& variants_;
  study::store& store_;
  std::optional<study::stopping> looks_;
  std::optional<io::temporary_folder> tables_; ///< with `--series`
  std::vector<state> states_;
  std::vector<std::pair<std::size_t, std::size_t>> missing_; ///< variant and number of the seed
  std::size_t next_ = 0;
};

study_summary summary_of(const sweep_command& x, std::vector<study::variant_values> variants,
                         const sweep_plan& plan, study::store& store) {
  study_summary out;
  for (const auto& each : x.variations)
    out.paths.push_back(each.path);
  out.variants = std::move(variants);
  out.quantile = x.quantile;
  if (plan.looks())
    out.confidence = plan.looks()->confidence();
  for (const auto& name : x.scalars.empty() ? usual_scalars() : x.scalars) {
    scalar_values all{name, {}};
    for (std::size_t i = 0; i < out.variants.size(); ++i)
      all.of_variants.push_back(store.values(plan.keys_of(i), name));
    out.scalars.push_back(std::move(all));
  }
  return out;
}

/// What is to be known of intervals that are looked at more than once.
std::string text_of(const study::stopping& x) {
  std::string looks;
  for (const auto each : x.looks())
    looks += (looks.empty() ? "" : ", ") + std::to_string(each);
  return "a variant ends after " + looks + " runs: each interval has " +
         percent_text(x.confidence()) + ", so that all looks together have " +
         percent_text(study::usual_confidence);
}

} // namespace

exit_status perform(const sweep_command& x) {
  auto variants = std::get<std::vector<study::variant_values>>(study::variants_of(x.variations));
  const auto seeds_less_one = x.seeds.last - x.seeds.first;
  if (seeds_less_one >= runs_max || (seeds_less_one + 1) * variants.size() > runs_max)
    return refuse("the sweep has more than " + std::to_string(runs_max) + " runs");
  const auto planned = plan_of(x, variants);
  if (!planned)
    return exit_status::refused;
  auto opened = study::store::open(x.database, study::store::access::write);
  if (const auto* why = std::get_if<std::string>(&opened))
    return refuse(x.database + ' ' + *why);
  auto& store = std::get<study::store>(opened);
  sweep_plan plan(x, *planned, store);
  const auto all = planned->size() * planned->front().keys.size();
  if (plan.looks())
    say(report::counted(planned->size(), "variant") + " of at most " +
        report::counted(planned->front().keys.size(), "run") + " in " + x.database + "; " +
        text_of(*plan.looks()));
  else
    say(report::counted(planned->size(), "variant") + ", " + report::counted(all, "run") +
        ", of which " + std::to_string(all - plan.expected()) + " in " + x.database);
  const auto status = result_runs(x.jobs, x.timeout).run_all(plan);
  const auto summary = summary_of(x, std::move(variants), plan, store);
  const auto out = console_of(stdout);
  if (!print(stdout, x.csv ? summary_csv(summary) : summary_text(summary, out.room(), out.colour)))
    return exit_status::refused;
  if (x.page_file.empty())
    return status;
  std::ofstream page(x.page_file, std::ios::binary | std::ios::trunc);
  page << sweep_page(x, summary, planned->front().from_wall);
  return page.flush() ? status : refuse(x.page_file + " cannot be written");
}

} // namespace rubicon::cli
