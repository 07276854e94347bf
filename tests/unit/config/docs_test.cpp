#include <fstream>
#include <sstream>
#include <string>

#include "config/load.hpp"
#include "config/toml/schema.hpp"
#include "support/catch.hpp"

using namespace rubicon::config;

namespace {

std::string reference() {
  std::ifstream file(RUBICON_SOURCE_DIR "/docs/configuration.md");
  REQUIRE(file);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

} // namespace

TEST_CASE("the tables of the configuration reference are those of the readers",
          "[config][docs][ACT-13]") {
  const auto text = reference();
  CHECK(with_tables(describe_file(), text) == text); // tools/key-tables writes them anew
}

TEST_CASE("the configuration reference has every table that a file may have",
          "[config][docs][ACT-13]") {
  const auto text = reference();
  const auto all = describe_file();
  const auto titles = titles_of(all);
  REQUIRE(titles.size() > 80);
  for (const auto& title : titles) {
    if (markdown_of(all, title).empty())
      continue; // its one key chooses what else there is
    CAPTURE(title);
    CHECK(text.find("<!-- keys of " + title + " -->\n| Key |") != std::string::npos);
  }
}

TEST_CASE("every key says what it means, and what it may be", "[config][docs][ACT-13]") {
  const auto all = describe_file();
  for (const auto& title : titles_of(all)) {
    std::istringstream rows(markdown_of(all, title));
    for (std::string row; std::getline(rows, row);) {
      CAPTURE(title, row);
      CHECK(row.find("|  |  |") == std::string::npos);
      CHECK_FALSE(row.ends_with("|  |"));
    }
  }
}
