#include "deploy/news_log.hpp"

#include <string>

#include "support/catch.hpp"

using namespace rubicon::deploy;

TEST_CASE("a log gives everybody what is new to him", "[deploy]") {
  news_log log;
  CHECK(log.after(0).lines.empty());
  log.add("one");
  log.add("two");
  const auto first = log.after(0);
  CHECK(first.lines == std::vector<std::string>{"one", "two"});
  CHECK(first.last == 2);
  log.add("three");
  CHECK(log.after(first.last).lines == std::vector<std::string>{"three"});
  CHECK(log.after(3).lines.empty());
  CHECK(log.after(99).lines.empty()); // of another log
  CHECK(log.after(99).last == 3);
}

TEST_CASE("a log that nobody reads stays small, and says what it has left out", "[deploy]") {
  news_log log;
  const auto all = news_log::lines_max + 10;
  for (std::size_t i = 1; i <= all; ++i)
    log.add(std::to_string(i));
  const auto page = log.after(3);
  CHECK(page.lines.size() == news_log::lines_max);
  CHECK(page.lines.front() == "11");
  CHECK(page.left_out == 7);
  CHECK(log.after(10).left_out == 0);
  log.add(std::string(2 * news_log::line_octets_max, 'x'));
  CHECK(log.after(all).lines.front().size() == news_log::line_octets_max);
}
