#include "control/octets.hpp"

#include "support/catch.hpp"

using namespace rubicon;
using control::octets_of;
using control::part_report_of;

namespace {

report::part_report some_part() {
  report::part_report x;
  x.report.ecology = "house";
  x.report.simulated = 5s;
  x.report.islands.resize(2);
  x.report.islands[1].radio.lost["collision"] = 7;
  x.report.islands[1].motes.resize(1);
  x.report.islands[1].motes[0].signal_dbm = -50;
  x.report.expectations.push_back(
      {"joined", report::expectation_report::verdict::met, "3 motes", instant(1s)});
  auto& program = x.counters.programs[{"kitchen/fan", 1, "sampler"}];
  program.sum.figures = {{"readings", 12.5}};
  x.counters.streams[{"robot", 9}].writer.newest_ms = 1234;
  x.counters.accounts[{{island_id(1), mote_id(2)}, "message"}].came_over = 3;
  return x;
}

} // namespace

TEST_CASE("what a part tells is the same in another process", "[control]") {
  const auto before = some_part();
  const auto octets = octets_of(before);
  const auto after = part_report_of(octets);
  REQUIRE(after);
  CHECK(report::to_json(after->report) == report::to_json(before.report));
  CHECK(after->report.islands[1].motes[0].signal_dbm == -50);
  CHECK(after->counters.streams.at({"robot", 9}).writer.newest_ms == 1234U);
  CHECK(octets_of(*after) == octets);
}

TEST_CASE("half of what a part tells is nothing", "[control]") {
  const auto octets = octets_of(some_part());
  for (std::size_t size = 0; size < octets.size(); ++size)
    CHECK_FALSE(part_report_of(byte_view(octets).first(size)));
}

TEST_CASE("each question and answer comes as what it was", "[control]") {
  deploy::offer offered{"id", "kitchen", {}, "warn", true};
  offered.what.files["a.csv"] = std::string("1\0002", 3);
  offered.what.length = 3min;
  const deploy::question all[] = {deploy::greeting{"1"},
                                  deploy::ask_facts{},
                                  offered,
                                  deploy::begin_part{"id", 2s},
                                  deploy::end_part{"id"},
                                  deploy::cause_fault{"id", "kill"},
                                  deploy::ask_news{"id", 3, 4},
                                  deploy::offer_seeds{"x", {}, 1s},
                                  deploy::run_seeds{"x", {1, 2}, 3, true},
                                  deploy::send_revoked{"-----"}};
  static_assert(std::size(all) == std::variant_size_v<deploy::question>);
  for (std::uint8_t kind = 0; kind < std::size(all); ++kind) {
    INFO(int(kind));
    REQUIRE(all[kind].index() == kind);
    const auto octets = octets_of(all[kind]);
    const auto found = control::question_of(kind, octets);
    REQUIRE(found);
    CHECK(found->index() == kind);
    CHECK(octets_of(*found) == octets);
  }
  deploy::news report;
  report.lines = {"one"};
  report.lives.push_back({7, 1s, 0s, false, some_part()});
  report.facts.state = deploy::part_state::running;
  const auto octets = octets_of(deploy::answer(report));
  const auto found = control::answer_of(control::answer_kind(6), octets);
  REQUIRE(found);
  CHECK(std::get<deploy::news>(*found).lives.at(0).newest.report.ecology == "house");
  CHECK(std::get<deploy::news>(*found).facts.state == deploy::part_state::running);
}

TEST_CASE("a kind that there is not, or of another message, is nothing", "[control]") {
  const auto octets = octets_of(deploy::question(deploy::greeting{"1"}));
  CHECK(control::question_of(0, octets));
  CHECK_FALSE(control::question_of(1, octets));
  CHECK_FALSE(control::question_of(std::variant_size_v<deploy::question>, octets));
  CHECK_FALSE(control::answer_of(255, octets));
}
