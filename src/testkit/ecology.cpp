#include "testkit/ecology.hpp"

#include <algorithm>
#include <regex>
#include <utility>
#include <variant>

#include <spdlog/spdlog.h>

#include "actors/peis/peis_peer.hpp"
#include "actors/run/ecology_run.hpp"
#include "actors/supervision/ecology.hpp"
#include "bridge/mqtt/broker_site.hpp"
#include "config/toml/document.hpp"
#include "config/toml/problem_text.hpp"
#include "report/fault_plan.hpp"

namespace rubicon::test {

namespace {

template <class State, class Handle>
State& state_of(const Handle& x) {
  return static_cast<scheduler::shell<State, typename Handle::interface>&>(x.get()).state;
}

config::ecology_description take(config::loaded from, const std::string& file) {
  if (!from.ecology)
    throw bad_description(config::text_of(from.problems, file));
  return *std::move(from.ecology);
}

std::string text_of_file(const std::string& path) {
  auto read = config::read_file(path, config::file_octets_max);
  if (!read.text)
    throw bad_description(config::text_of({config::problem{path, 0, 0, read.reason}}, path));
  return *std::move(read.text);
}

/// @param mode unset: what the text says
config::loaded load(std::string_view toml, const std::string& name, const ecology_options& options,
                    std::optional<config::run_mode> mode) {
  config::overrides instead;
  instead.seed = options.seed;
  instead.mode = mode;
  return config::load_with_files(toml, name, instead, options.known);
}

constexpr auto virtual_time = config::run_mode::virtual_time;

/// How problems call a text.
constexpr const char* text_name = "ecology";

/// Whether a fault needs what the ecology makes for it when it begins.
bool needs_preparation(const config::fault& x) {
  const auto* crash = std::get_if<config::crash_fault>(&x);
  return std::holds_alternative<config::noise_fault>(x) ||
         std::holds_alternative<config::mote_double_fault>(x) ||
         std::holds_alternative<config::move_island_fault>(x) ||
         (crash != nullptr && crash->becomes);
}

/// How problems call the words of a fault.
constexpr const char* fault_name = "fault";
constexpr std::string_view fault_heading = "[[fault]]";

} // namespace

class ecology::parts {
public:
  parts(config::ecology_description x, std::optional<std::string> text, std::string name,
        ecology_options options)
      : description_(std::move(x)), text_(std::move(text)), name_(std::move(name)),
        options_(std::move(options)) {
    spdlog::set_level(spdlog::level::err);
    description_.mode = virtual_time;
    description_.seed = options_.seed.value_or(description_.seed);
  }

  static std::unique_ptr<parts> of_text(std::string text, const std::string& name,
                                        ecology_options options) {
    auto x = take(load(text, name, options, virtual_time), name);
    return std::make_unique<parts>(std::move(x), std::move(text), name, std::move(options));
  }

  ecology_run& run() {
    if (!run_)
      run_.emplace(description_, run_options{});
    return *run_;
  }

  [[nodiscard]] instant now() { return run_ ? run_->world().now() : instant{}; }

  void inject(config::fault_description x) {
    if (!run_) {
      description_.faults.push_back(std::move(x));
      return;
    }
    if (needs_preparation(x.what))
      throw bad_description("fault: it needs a radio that is not there: name it in the "
                            "description, or before time goes on\n");
    run().plan(x, times_of(x));
    static_cast<void>(run().world().drain());
  }

  /// @param heading of the table: `[[fault]]` or `[[change]]`
  config::fault_description read_fault(std::string_view words, std::string_view heading) {
    if (!text_)
      throw std::logic_error("an ecology that is built in code is given faults in code");
    static const std::regex says_when("(^|\n)[ \t]*(at|every|random)[ \t]*=");
    auto all = *text_ + '\n' + std::string(heading) + '\n';
    auto lines_before = std::ranges::count(all, '\n');
    if (!std::regex_search(words.begin(), words.end(), says_when)) {
      all += "at = \"" + std::to_string(now().time_since_epoch().count()) + "ns\"\n";
      ++lines_before;
    }
    all += words;
    auto loaded = load(all, name_, options_, virtual_time);
    for (auto& each : loaded.problems)
      if (each.file == name_ && each.line > lines_before) {
        each.file = fault_name;
        each.line -= static_cast<unsigned>(lines_before);
      }
    const auto planned = take(std::move(loaded), fault_name).faults; // changes are the last
    const bool is_fault = heading == fault_heading;
    return *std::find_if(planned.rbegin(), planned.rend(), [is_fault](const auto& each) {
      return config::is_change(each) != is_fault;
    });
  }

  /// nullptr: it does not run.
  const peis::kernel* kernel_of(std::string_view name) {
    const auto& handle = supervised(name).handle;
    return handle ? &state_of<peis_peer_state>(handle).kernel : nullptr;
  }

  const bridge::simulated_broker& broker_of(std::string_view name) {
    const auto& site = supervised(name).broker;
    if (site == nullptr)
      throw failure(std::string(name) + " has no MQTT bridge");
    return site->broker();
  }

  peer_id id_of(std::string_view name) { return supervised(name).id; }

  const std::vector<report::logged_event>& log() {
    return state_of<ecology_state>(run().root()).report.event_log;
  }

  report::run_report finish() { return run().finish(); }

private:
  [[nodiscard]] std::vector<duration> times_of(const config::fault_description& x) {
    // The run may be made longer than it was to be.
    auto times = report::times_of(x, 0, description_.seed, std::max(description_.length, x.at));
    std::erase_if(times, [this](duration at) { return instant(at) < now(); });
    if (times.empty())
      throw bad_description("fault: it would be in the past\n");
    return times;
  }

  supervised_peer& supervised(std::string_view name) {
    auto& peers = state_of<ecology_state>(run().root()).peers;
    const auto found = peers.find(std::string(name));
    if (found == peers.end())
      throw failure("no peer is called " + std::string(name));
    return found->second;
  }

  config::ecology_description description_;
  std::optional<std::string> text_; ///< unset: built in code
  std::string name_;
  ecology_options options_;
  std::optional<ecology_run> run_; ///< from the first time that it is looked at or goes on
};

config::ecology_description describe(std::string_view toml, const ecology_options& options) {
  return take(load(toml, text_name, options, std::nullopt), text_name);
}

config::ecology_description describe_file(const std::string& path, const ecology_options& options) {
  return take(load(text_of_file(path), path, options, std::nullopt), path);
}

report::run_report run(const config::ecology_description& what, std::uint64_t seed) {
  spdlog::set_level(spdlog::level::err); // an error in the log is worth seeing, the rest is noise
  run_options options;
  options.seed = seed;
  return run_ecology(what, options);
}

ecology::ecology(std::string_view toml, ecology_options options)
    : ecology(parts::of_text(std::string(toml), text_name, std::move(options))) {}

ecology::ecology(std::unique_ptr<parts> x) : parts_(std::move(x)) {}

ecology ecology::of_file(const std::string& path, ecology_options options) {
  return ecology(parts::of_text(text_of_file(path), path, std::move(options)));
}

ecology::ecology(config::ecology_description description, ecology_options options)
    : parts_(std::make_unique<parts>(std::move(description), std::nullopt, text_name,
                                     std::move(options))) {}

ecology::~ecology() = default;
ecology::ecology(ecology&&) noexcept = default;
ecology& ecology::operator=(ecology&&) noexcept = default;

instant ecology::now() const {
  return parts_->now();
}

void ecology::run_for(duration length) {
  run_until(now() + length);
}

void ecology::run_until(instant end) {
  parts_->run().run_until(end);
  static_cast<void>(parts_->run().world()); // throws if the run has broken off
}

bool ecology::run_until(const std::function<bool()>& done, duration limit, duration step) {
  const auto latest = now() + limit;
  while (!done() && now() < latest) {
    const auto before = now();
    run_for(std::min(step, latest - before));
    if (now() == before) // a flat battery has ended the run
      break;
  }
  return done();
}

void ecology::inject(std::string_view words) {
  parts_->inject(parts_->read_fault(words, fault_heading));
}

void ecology::change(std::string_view words) {
  parts_->inject(parts_->read_fault(words, "[[change]]"));
}

void ecology::inject(config::fault_description x) {
  parts_->inject(std::move(x));
}

report::run_report ecology::report() {
  return parts_->run().report_so_far();
}

void ecology::check_invariants() {
  const auto found = told_violations(report());
  if (!found.empty())
    throw failure("violated invariants:\n" + found);
}

std::optional<std::string> ecology::tuple(std::string_view peer, std::string_view key) {
  return tuple(peer, peer, key);
}

std::optional<std::string> ecology::tuple(std::string_view peer, std::string_view owner,
                                          std::string_view key) {
  const auto of = parts_->id_of(owner);
  const auto* kernel = parts_->kernel_of(peer);
  const auto found = kernel == nullptr ? nullptr : kernel->reader().find(of, key);
  return found ? std::optional(std::string(found->text())) : std::nullopt;
}

const std::map<std::string, std::string>& ecology::retained(std::string_view peer) {
  return parts_->broker_of(peer).retained();
}

bool ecology::logged(std::string_view who, std::string_view what) {
  return has_logged(parts_->log(), who, what);
}

report::run_report ecology::finish() {
  return parts_->finish();
}

} // namespace rubicon::test
