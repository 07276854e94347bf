#include "recorded.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "actors/run/run.hpp"
#include "support/catch.hpp"

namespace rubicon::test {

std::vector<instant> recorded::times(explain::kind what, std::string_view to,
                                     std::string_view text) const {
  std::vector<instant> all;
  for (const auto& x : content.records) {
    const bool deleted = what == explain::kind::tuple_event && x.yes;
    if (x.what == what && x.to.starts_with(to) && x.text.starts_with(text) && !deleted)
      all.push_back(x.time);
  }
  return all;
}

std::vector<set_value> recorded::at(std::string_view key) const {
  std::vector<set_value> out;
  for (const auto& x : content.records)
    if (x.what == explain::kind::set_tuple && x.text == key)
      out.push_back({x.time, to_string(x.octets)});
  return out;
}

std::vector<std::string> recorded::texts_at(std::string_view key) const {
  std::vector<std::string> out;
  for (const auto& x : at(key))
    out.push_back(x.text);
  return out;
}

recorded run_recorded(const config::ecology_description& what, std::uint64_t seed) {
  spdlog::set_level(spdlog::level::err);
  const auto file =
      std::filesystem::temp_directory_path() / ("rubicon-test-" + std::to_string(getpid()));
  run_options options;
  options.seed = seed;
  options.record_file = file.string();
  recorded x;
  x.report = run_ecology(what, options);
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  auto read = explain::read(text);
  std::filesystem::remove(file);
  REQUIRE(!read.problem);
  CHECK(!read.content.cut_off);
  x.content = std::move(read.content);
  return x;
}

} // namespace rubicon::test
