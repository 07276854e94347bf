#include "cli/print/event_lines.hpp"
#include "cli/print/progress_bar.hpp"
#include "report/print/text_layout.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;
using rubicon::report::display_width;

TEST_CASE("an event is told in one line, with its time", "[cli]") {
  CHECK(event_line({instant{} + 12'004ms + 900us, "kitchen/fan", "joined"}) ==
        " 0:12.004  kitchen/fan  joined");
  CHECK(event_line({instant{} + 1s, "a", "left"}, 27h + 59min) == "27:59:01.000  a  left");
  CHECK(event_line({instant{}, "x\033[2J", "joined\n9.0 forged"}) ==
        " 0:00.000  x\\x1b[2J  joined\\n9.0 forged");
}

TEST_CASE("a run in wall time tells how far it is, within its terminal", "[cli]") {
  CHECK(wall_progress_text(65s, 10min, 1204.4, 12, 80) ==
        "1:05 of 10:00  10%  1,204 events/s  12 motes joined");
  CHECK(wall_progress_text(0s, 0s, 0, 0, 80) == "0:00 of 0:00  100%  0 events/s");
  for (std::size_t width = 0; width < 80; ++width)
    CHECK(display_width(wall_progress_text(5h, 24h, 1e6, 1000, width)) <= width);
}

TEST_CASE("events stand above the progress, which stays below them", "[cli]") {
  live_log log(/*has_progress=*/true, 80);
  const report::logged_event joined{instant{} + 1s, "kitchen/fan", "joined"};
  CHECK(log.add_event(1s, joined) == " 0:01.000  kitchen/fan  joined\n"); // nothing to erase yet
  const auto drawn = log.update(2s, instant{} + 2s, instant{} + 10s, 200);
  CHECK(drawn == std::string(erase_line) + "0:02 of 0:10  20%  100 events/s  1 mote joined");
  CHECK(
      log.update(2s + live_log::redrawn_every - 1ns, instant{} + 3s, instant{} + 10s, 999).empty());
  const report::logged_event left{instant{} + 3s, "kitchen/fan", "left: silent"};
  CHECK(log.add_event(3s, left) == std::string(erase_line) +
                                       " 0:03.000  kitchen/fan  left: silent\n" +
                                       drawn.substr(erase_line.size()));
  CHECK(log.update(4s, instant{} + 4s, instant{} + 10s, 300) ==
        std::string(erase_line) + "0:04 of 0:10  40%  50 events/s");
  CHECK(log.finish() == erase_line);
  CHECK(log.finish().empty());
}

TEST_CASE("a mote that joins again counts once", "[cli]") {
  live_log log(true, 80);
  static_cast<void>(log.add_event(0s, {instant{}, "a/b", "joined"}));
  static_cast<void>(log.add_event(0s, {instant{}, "a/b", "joined again, life 2"}));
  CHECK(log.update(1s, instant{} + 1s, instant{} + 10s, 0).ends_with("1 mote joined"));
}

TEST_CASE("without a terminal there are the events and nothing else", "[cli]") {
  live_log log(/*has_progress=*/false, 80);
  CHECK(log.update(2s, instant{} + 2s, instant{} + 10s, 200).empty());
  CHECK(log.add_event(0s, {instant{} + 3s, "a", "b"}) == " 0:03.000  a  b\n");
  CHECK(log.finish().empty());
}

TEST_CASE("of a flood of events some are told in a second, and how many more there were", "[cli]") {
  for (const bool has_progress : {false, true}) {
    live_log log(has_progress, 80);
    const auto add = [&log](duration real) { return log.add_event(real, {instant{}, "a", "b"}); };
    for (std::uint64_t i = 0; i < rate_limiter::lines_max; ++i)
      CHECK_FALSE(add(5s).empty());
    for (int i = 0; i < 1234; ++i)
      CHECK(add(5s + 999ms).empty());
    CHECK(log.update(5s + 999ms, instant{}, instant{}, 0).find("more") == std::string::npos);
    const std::string more = "and 1,234 more events within a second; --csv DIR keeps all\n";
    CHECK(log.update(6s, instant{}, instant{}, 0).find(more) != std::string::npos);
    for (std::uint64_t i = 0; i <= rate_limiter::lines_max; ++i)
      static_cast<void>(add(6s));
    CHECK(add(7s).find("and 1 more event within") != std::string::npos);
    for (std::uint64_t i = 0; i < rate_limiter::lines_max; ++i)
      static_cast<void>(add(7s));
    CHECK(log.finish().find("and 1 more event within") != std::string::npos);
    CHECK(log.finish().empty());
  }
}
