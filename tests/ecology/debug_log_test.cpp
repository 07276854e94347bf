#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// A folder of its own that ends with the test.
struct scratch_folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("rubicon-debug-test-" + std::to_string(getpid()));
  ~scratch_folder() { std::filesystem::remove_all(path); }
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

} // namespace

TEST_CASE("debug mode writes each module's messages, sent and received", "[ecology][NFR-01]") {
  const scratch_folder folder;
  spdlog::set_level(spdlog::level::err);
  auto home = example("home.toml");
  home.length = 20s;
  run_options options;
  options.debug_folder = folder.path.string();
  const auto with = run_ecology(home, options);
  for (const auto* module : {"air", "mote", "sink", "serial_line", "gateway", "peis_peer", "proxy",
                             "proxy_manager", "mote_app"}) {
    const auto lines = text_of(folder.path / (std::string(module) + ".log"));
    CHECK_FALSE(lines.empty());
    CHECK(lines.find("<unprintable>") == std::string::npos);
  }
  const auto motes = text_of(folder.path / "mote.log");
  CHECK(motes.find("mote/kitchen/fan received from=air/kitchen length=") != std::string::npos);
  CHECK(motes.find("mote/kitchen/fan sent to=air/kitchen length=") != std::string::npos);

  // Watching changes nothing, and without it no file is written.
  std::filesystem::remove_all(folder.path);
  const auto without = run_ecology(home, {});
  CHECK(with.trace_hash == without.trace_hash);
  CHECK_FALSE(std::filesystem::exists(folder.path));
}

TEST_CASE("debug logs are rotated and stay within their limit", "[ecology][NFR-03]") {
  const scratch_folder folder;
  spdlog::set_level(spdlog::level::err);
  run_options options;
  options.debug_folder = folder.path.string();
  options.debug_file_octets_max = 100'000;
  static_cast<void>(run_ecology(example("home.toml"), options));
  std::map<std::string, std::uintmax_t> octets;
  for (const auto& file : std::filesystem::directory_iterator(folder.path)) {
    const auto name = file.path().filename().string();
    octets[name.substr(0, name.find('.'))] += file.file_size();
  }
  CHECK(std::filesystem::exists(folder.path / "peis_peer.2.log")); // there was more than fits
  for (const auto& [module, size] : octets)
    CHECK(size <= 3 * 100'000);
}

TEST_CASE("a debug folder that cannot be made is an error", "[ecology][NFR-01]") {
  run_options options;
  options.debug_folder = "/proc/rubicon";
  CHECK_THROWS_AS(run_ecology(example("home.toml"), options), std::runtime_error);
}
