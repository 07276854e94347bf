#include "cli/print/progress_bar.hpp"
#include "report/print/text_layout.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;
using rubicon::report::display_width;

TEST_CASE("a progress text tells how far, how fast and how long still", "[cli]") {
  CHECK(progress_text(2s, 5min, 10min, 80) ==
        "▕██████████          ▏   50%   5:00 of 10:00  150 ×  2 s left");
  CHECK(progress_text(2s, 0s, 10min, 80) ==
        "▕                    ▏    0%   0:00 of 10:00  0.0 ×  –");
  CHECK(progress_text(100s, 10min, 24h, 80) ==
        "▕▏                   ▏    0%     10:00 of 24:00:00  6.0 ×  3 h 58 min left");
}

TEST_CASE("a progress text fits its terminal", "[cli]") {
  for (std::size_t width = 0; width < 120; ++width) {
    CAPTURE(width);
    CHECK(display_width(progress_text(65s, 13min, 3h, width)) <= width);
  }
  CHECK(progress_text(2s, 5min, 10min, 30).find("50%") != std::string::npos);
}

TEST_CASE("a bar is full at the end and never fuller", "[cli]") {
  const auto full = progress_text(2s, 10min, 10min, 80);
  CHECK(full.find("▕████████████████████▏  100%") != std::string::npos);
  CHECK(progress_text(2s, 11min, 10min, 80).find("▏  100%") != std::string::npos);
  CHECK(progress_text(2s, 0s, 0s, 80).find("100%") != std::string::npos);
}

TEST_CASE("a run shorter than a second shows no bar and leaves no trace", "[cli]") {
  progress_bar bar(80);
  CHECK(bar.update(0s, instant{}, instant{} + 10min).empty());
  CHECK(bar.update(999ms, instant{} + 9min, instant{} + 10min).empty());
  CHECK(bar.finish().empty());
}

TEST_CASE("a longer run redraws its bar ten times a second and erases it", "[cli]") {
  progress_bar bar(80);
  const auto drawn = bar.update(1s, instant{} + 1min, instant{} + 10min);
  CHECK(drawn.starts_with(erase_line));
  CHECK(display_width(drawn.substr(erase_line.size())) < 80);
  CHECK(bar.update(1099ms, instant{} + 2min, instant{} + 10min).empty());
  CHECK(!bar.update(1100ms, instant{} + 2min, instant{} + 10min).empty());
  CHECK(bar.finish() == erase_line);
  CHECK(bar.finish().empty());
}
