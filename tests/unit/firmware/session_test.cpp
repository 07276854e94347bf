#include "firmware/session.hpp"

#include <memory>
#include <string>
#include <vector>

#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::firmware;

namespace {

/// A firmware that does in its next call what a test wants, and notes how it was called.
struct scripted_code final : code {
  struct state {
    host* of = nullptr;
    identity who;
    std::function<void(host&)> next;
    std::vector<std::string> calls;
  };
  std::shared_ptr<state> at;

  explicit scripted_code(std::shared_ptr<state> x) : at(std::move(x)) {}

  void init(const identity& who, host& of) override {
    at->of = &of;
    at->who = who;
    at->calls.emplace_back("init");
  }
  void run(std::uint64_t now_us) override { note("run", now_us); }
  void received(std::uint64_t now_us, byte_view frame, int rssi_dbm) override {
    note("received " + to_hex(frame) + ' ' + std::to_string(rssi_dbm), now_us);
  }
  void sent(std::uint64_t now_us, outcome how) override {
    note("sent " + std::to_string(how), now_us);
  }

private:
  void note(const std::string& what, std::uint64_t now_us) const {
    at->calls.push_back(what + " at " + std::to_string(now_us));
    if (const auto then = std::exchange(at->next, nullptr))
      then(*at->of);
  }
};

struct session_fixture {
  std::shared_ptr<scripted_code::state> code = std::make_shared<scripted_code::state>();
  session runs{std::make_unique<scripted_code>(code), {7, 20, 15}, random_stream(1), [](auto name) {
                 return name == "light" ? std::optional(42) : std::nullopt;
               }};
  instant begin = instant(1h);

  /// Starts it, and does that in its first call.
  outputs start(std::function<void(host&)> first = {}) {
    code->next = std::move(first);
    return runs.start(begin);
  }
};

const bytes sample_frame{0x41, 0x88, 1, 0x22, 0};

} // namespace

TEST_CASE("the time of a firmware begins with its mote", "[firmware]") {
  session_fixture x;
  CHECK(x.start([](host& h) { h.set_timer(2500); }).empty());
  CHECK(x.code->who.mote == 7);
  CHECK(x.code->who.island == 20);
  CHECK(x.code->who.channel == 15);
  REQUIRE(x.runs.deadline() == x.begin + 2500us);
  CHECK(x.runs.on_time(x.begin + 2499us).empty());
  CHECK(x.runs.on_time(x.begin + 2500us).empty());
  CHECK(!x.runs.deadline());
  CHECK(x.runs.on_frame(sample_frame, -70, x.begin + 3ms).empty());
  CHECK(x.code->calls == std::vector<std::string>{"init", "run at 0", "run at 2500",
                                                  "received 4188012200 -70 at 3000"});
}

TEST_CASE("a timer of the past is postponed, and one beyond all time is none", "[firmware]") {
  session_fixture x;
  CHECK(x.start([](host& h) { h.set_timer(0); }).empty());
  CHECK(x.runs.deadline() == x.begin + run_pause_min);
  CHECK(x.runs.counters().early_timers == 1);
  x.code->next = [](host& h) { h.set_timer(~std::uint64_t{0}); };
  CHECK(x.runs.on_time(x.begin + run_pause_min).empty());
  CHECK(!x.runs.deadline());
}

TEST_CASE("four frames of a firmware may be open, and no more", "[firmware]") {
  session_fixture x;
  std::vector<answer> answers;
  const auto sends = [&](host& h) {
    for (std::size_t i = 0; i < open_frames_max + 1; ++i)
      answers.push_back(h.send(sample_frame));
  };
  const auto out = x.start(sends);
  CHECK(out.size() == open_frames_max);
  CHECK(std::get<send_frame>(out.at(0)).octets == sample_frame);
  CHECK(answers == std::vector<answer>{RUBICON_MOTE_OK, RUBICON_MOTE_OK, RUBICON_MOTE_OK,
                                       RUBICON_MOTE_OK, RUBICON_MOTE_FULL});
  CHECK(x.runs.counters().frames_full == 1);
  answers.clear();
  x.code->next = sends;
  CHECK(x.runs.on_sent(RUBICON_MOTE_NO_ACK, x.begin + 1ms).size() == 1);
  CHECK(answers.at(0) == RUBICON_MOTE_OK);
  CHECK(answers.at(1) == RUBICON_MOTE_FULL);
  CHECK(x.runs.counters().unsent == 1);
  CHECK(x.code->calls.back() == "sent 1 at 1000");
}

TEST_CASE("what is no frame for a radio is refused", "[firmware]") {
  session_fixture x;
  std::vector<answer> answers;
  CHECK(
      x.start([&](host& h) {
         for (const auto& each : {bytes{}, bytes{0x41, 0x88}, bytes(126, 0x41), bytes{0x02, 0, 9}})
           answers.push_back(h.send(each));
         answers.push_back(h.send(bytes(125, 0x41)));
       }).size() == 1);
  CHECK(answers == std::vector<answer>{RUBICON_MOTE_INVALID, RUBICON_MOTE_INVALID,
                                       RUBICON_MOTE_INVALID, RUBICON_MOTE_INVALID,
                                       RUBICON_MOTE_OK});
  CHECK(x.runs.counters().frames_invalid == 4);
}

TEST_CASE("lines of a firmware are cut, printable and limited", "[firmware]") {
  session_fixture x;
  const auto out = x.start([](host& h) {
    h.log("a\x01z");
    h.log(std::string(line_octets_max + 1, 'x'));
    h.write_serial(to_bytes(std::string_view("one\r\ntwo")));
    for (std::size_t i = 0; i < lines_max; ++i)
      h.log("more");
  });
  REQUIRE(out.size() == lines_max);
  CHECK(std::get<write_line>(out.at(0)).text == "a?z");
  CHECK(std::get<write_line>(out.at(1)).text.size() == line_octets_max);
  CHECK(std::get<write_line>(out.at(2)).text == "one");
  CHECK(std::get<write_line>(out.at(2)).serial);
  CHECK(x.runs.counters().lines_dropped == 3);
  CHECK(x.runs.counters().serial_octets == 8);
  x.code->next = [](host& h) { h.write_serial(to_bytes(std::string_view("!\n"))); };
  const auto rest = x.runs.on_frame(sample_frame, -70, x.begin + 1ms);
  CHECK(std::get<write_line>(rest.at(0)).text == "two!");
}

TEST_CASE("of switches between two frames of a firmware the last counts", "[firmware]") {
  session_fixture x;
  const auto out = x.start([](host& h) {
    for (int i = 0; i < 100; ++i) {
      h.set_radio(false);
      h.set_leds(0x102U);
      h.set_radio(true);
    }
    static_cast<void>(h.send(sample_frame));
    h.set_radio(false);
  });
  REQUIRE(out.size() == 4);
  CHECK(std::get<switch_radio>(out.at(0)).on);
  CHECK(std::get<show_leds>(out.at(1)).on == 2);
  CHECK(std::holds_alternative<send_frame>(out.at(2)));
  CHECK(!std::get<switch_radio>(out.at(3)).on);
}

TEST_CASE("a firmware reads sensors of its mote, and draws the same numbers in each run",
          "[firmware]") {
  const auto drawn = [] {
    session_fixture x;
    std::vector<std::uint32_t> numbers;
    static_cast<void>(x.start([&](host& h) {
      CHECK(h.read("light") == 42);
      CHECK(!h.read("sound"));
      numbers = {h.draw(), h.draw()};
    }));
    CHECK(x.runs.counters().absent_sensors == 1);
    return numbers;
  };
  CHECK(drawn() == drawn());
  CHECK(drawn().at(0) != drawn().at(1));
}

TEST_CASE("a firmware may still print while it is switched off", "[firmware]") {
  struct last_words final : code {
    host* of = nullptr;

    ~last_words() override {
      if (of == nullptr)
        return;
      of->write_serial(to_bytes(std::string_view("counted 7\n")));
      static_cast<void>(of->send(sample_frame));
    }
    void init(const identity& /*who*/, host& its) override { of = &its; }
    void run(std::uint64_t /*now_us*/) override {
      of->write_serial(to_bytes(std::string_view("a line that has not ended, and is not short")));
    }
    void received(std::uint64_t /*now_us*/, byte_view /*frame*/, int /*rssi_dbm*/) override {}
    void sent(std::uint64_t /*now_us*/, outcome /*how*/) override {}
  };
  session runs(std::make_unique<last_words>(), {7, 20, 15}, random_stream(1), {});
  CHECK(runs.start(instant(1h)).empty());
}
