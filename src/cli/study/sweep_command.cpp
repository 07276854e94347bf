#include "cli/study/sweep_command.hpp"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "cli/ecology_file.hpp"
#include "cli/own_binary.hpp"
#include "cli/print/console.hpp"
#include "cli/run/child_runs.hpp"
#include "cli/study/sweep_text.hpp"
#include "cli/swarm.hpp"
#include "config/toml/units.hpp"
#include "core/hash.hpp"
#include "deploy/bundle.hpp"
#include "report/figures.hpp"
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
  planned_variant out{x.settings, {}, {}, {}};
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

/// The runs in progress.
class sweep_runs {
public:
  sweep_runs(const sweep_command& x, const std::vector<planned_variant>& plan, study::store& store)
      : command_(x), plan_(plan), store_(store),
        jobs_(std::max<std::uint64_t>(1, x.jobs.value_or(std::thread::hardware_concurrency()))),
        runs_(x.timeout) {
    for (std::size_t i = 0; i < plan.size(); ++i)
      for (std::size_t j = 0; j < plan[i].keys.size(); ++j) {
        if (store.has(plan[i].keys[j]))
          store.add_parameters(plan[i].keys[j], plan[i].parameters);
        else
          missing_.emplace_back(i, j);
      }
  }

  [[nodiscard]] std::size_t missing() const { return missing_.size(); }

  exit_status run_all() {
    for (start_some(); runs_.size() > 0 && !runs_.interrupted(); start_some())
      for (const auto& each : runs_.wait(500ms))
        collect(each);
    runs_.kill_all();
    return runs_.interrupted() ? exit_status::interrupted
           : failed_           ? exit_status::failed
                               : exit_status::good;
  }

private:
  [[nodiscard]] std::uint64_t seed_of(std::size_t number) const {
    return command_.seeds.first + number;
  }

  void start_some() {
    for (; runs_.size() < jobs_ && next_ < missing_.size(); ++next_) {
      const auto [variant, number] = missing_[next_];
      runs_.start(next_, run_words(command_.file, seed_of(number), command_.length,
                                   plan_[variant].settings));
    }
  }

  void collect(const child_runs::ended_run& x) {
    if (runs_.interrupted())
      return;
    const auto [variant, number] = missing_[x.id];
    const auto seed = seed_of(number);
    const auto judged = judge(seed, x.how, x.real, x.overran);
    auto result = result_of(x.how.out);
    if (!judged) {
      runs_.interrupt(); // the same Ctrl-C that comes to us
    } else if (!result || x.overran || x.how.signal != 0 || x.how.overlong) {
      failed_ = true;
      for (const auto& each : judged->violations)
        say(plan_[variant].label + ", seed " + std::to_string(seed) + ": " + each.detail);
    } else {
      result->key = plan_[variant].keys[number];
      result->file = command_.file;
      result->seed = seed;
      result->real_s = seconds(x.real);
      result->parameters = plan_[variant].parameters;
      store_.add(*result);
    }
  }

  const sweep_command& command_;
  const std::vector<planned_variant>& plan_;
  study::store& store_;
  const std::uint64_t jobs_;
  std::vector<std::pair<std::size_t, std::size_t>> missing_; ///< variant and number of the seed
  std::size_t next_ = 0;
  bool failed_ = false;
  child_runs runs_;
};

study_summary summary_of(const sweep_command& x, std::vector<study::variant_values> variants,
                         const std::vector<planned_variant>& plan, study::store& store) {
  study_summary out;
  for (const auto& each : x.variations)
    out.paths.push_back(each.path);
  out.variants = std::move(variants);
  for (const auto& name : x.scalars.empty() ? usual_scalars() : x.scalars) {
    scalar_values all{name, {}};
    for (const auto& each : plan)
      all.of_variants.push_back(store.values(each.keys, name));
    out.scalars.push_back(std::move(all));
  }
  return out;
}

} // namespace

exit_status perform(const sweep_command& x) {
  auto variants = std::get<std::vector<study::variant_values>>(study::variants_of(x.variations));
  const auto seeds_less_one = x.seeds.last - x.seeds.first;
  if (seeds_less_one >= runs_max || (seeds_less_one + 1) * variants.size() > runs_max)
    return refuse("the sweep has more than " + std::to_string(runs_max) + " runs");
  const auto plan = plan_of(x, variants);
  if (!plan)
    return exit_status::refused;
  auto opened = study::store::open(x.database, study::store::access::write);
  if (const auto* why = std::get_if<std::string>(&opened))
    return refuse(x.database + ' ' + *why);
  auto& store = std::get<study::store>(opened);
  sweep_runs runs(x, *plan, store);
  const auto all = plan->size() * plan->front().keys.size();
  say(report::counted(plan->size(), "variant") + ", " + report::counted(all, "run") +
      ", of which " + std::to_string(all - runs.missing()) + " in " + x.database);
  const auto status = runs.run_all();
  const auto summary = summary_of(x, std::move(variants), *plan, store);
  const auto out = console_of(stdout);
  if (!print(stdout, x.csv ? summary_csv(summary) : summary_text(summary, out.room(), out.colour)))
    return exit_status::refused;
  return status;
}

} // namespace rubicon::cli
