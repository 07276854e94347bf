#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "config/load.hpp"
#include "support/catch.hpp"

using namespace rubicon::config;

namespace {

/// Text of docs/configuration.md under each of its headings; the heading is a part of it.
std::map<std::string, std::string> sections() {
  std::ifstream file(RUBICON_SOURCE_DIR "/docs/configuration.md");
  REQUIRE(file);
  std::map<std::string, std::string> found;
  std::string heading;
  bool code = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```"))
      code = !code;
    if (!code && line.starts_with('#'))
      heading = line.substr(line.find(' ') + 1);
    found[heading] += line + '\n';
  }
  return found;
}

/// What the readers call a table is its heading, between back-quotes.
std::string heading_of(const std::string& title) {
  return title == "the file" ? "Tables of the file" : '`' + title + '`';
}

/// The keys in the first column of a section's table.
std::set<std::string> documented_keys(const std::string& section) {
  std::set<std::string> keys;
  std::istringstream lines(section);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("| `"))
      keys.insert(line.substr(3, line.find('`', 3) - 3));
  }
  return keys;
}

} // namespace

TEST_CASE("the configuration reference has every key a file may have", "[config][docs][ACT-13]") {
  const auto all = sections();
  REQUIRE(accepted_keys().size() > 160);
  for (const auto& [title, key] : accepted_keys()) {
    CAPTURE(title, key);
    const auto section = all.find(heading_of(title));
    REQUIRE(section != all.end());
    const bool chosen_in_heading = title.find(key + " = \"") != std::string::npos;
    CHECK((chosen_in_heading || documented_keys(section->second).contains(key)));
  }
}

TEST_CASE("the configuration reference has no key that a file may not have",
          "[config][docs][ACT-13]") {
  std::map<std::string, std::set<std::string>> accepted;
  for (const auto& [title, key] : accepted_keys())
    accepted[heading_of(title)].insert(key);
  for (const auto& [heading, section] : sections()) {
    if (!accepted.contains(heading))
      continue;
    for (const auto& key : documented_keys(section)) {
      CAPTURE(heading, key);
      CHECK(accepted[heading].contains(key));
    }
  }
}
