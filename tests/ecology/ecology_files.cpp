#include "ecology_files.hpp"

#include <stdexcept>

#include <spdlog/spdlog.h>

#include "config/load.hpp"

namespace rubicon::test {

namespace {

config::ecology_description take(config::loaded from) {
  if (from.ecology)
    return *std::move(from.ecology);
  throw std::runtime_error(from.problems.empty() ? "no ecology"
                                                 : config::to_string(from.problems.front()));
}

} // namespace

config::ecology_description example(std::string_view file) {
  return take(config::load_file(std::string(RUBICON_CONFIG_DIR "/").append(file)));
}

config::ecology_description ecology_of(std::string_view toml) {
  return take(config::load_text(toml, "test"));
}

runtime::report run(const config::ecology_description& what, std::uint64_t seed) {
  spdlog::set_level(spdlog::level::err); // an error in the log is worth seeing, the rest is noise
  run_options options;
  options.seed = seed;
  return run_ecology(what, options);
}

bool tells(const runtime::report& x, std::string_view who, std::string_view what) {
  return std::ranges::any_of(x.story, [&](const runtime::story_line& line) {
    return line.who.ends_with(who) && line.what.starts_with(what);
  });
}

std::string told_violations(const runtime::report& x) {
  std::string all;
  for (const auto& each : x.violations)
    all += each.invariant + ": " + each.detail + '\n';
  return all;
}

const runtime::proxy_report& proxy_of(const runtime::report& x, std::string_view name) {
  const auto found = std::ranges::find(x.proxies, name, &runtime::proxy_report::name);
  if (found == x.proxies.end())
    throw std::runtime_error("no proxy " + std::string(name));
  return *found;
}

std::string value(const runtime::proxy_report& x, std::string_view name) {
  const auto found = std::ranges::find(
      x.values, name, [](const auto& entry) { return std::string_view(entry.first); });
  return found == x.values.end() ? std::string() : found->second;
}

} // namespace rubicon::test
