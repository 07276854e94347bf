#include <algorithm>
#include <string>
#include <vector>

#include "peisinit/supervisor.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::peisinit;

namespace {

component program(const std::string& name, bool on = true) {
  component x;
  x.name = name;
  x.id = peer_id{31};
  x.command = "exec " + name + " $PEISINIT";
  x.on = on;
  return x;
}

component peer(const std::string& name) {
  component x;
  x.name = name;
  x.id = peer_id{32};
  x.peer = name;
  return x;
}

template <class Output>
std::vector<Output> all(const outputs& from) {
  std::vector<Output> found;
  for (const auto& each : from) {
    if (const auto* x = std::get_if<Output>(&each))
      found.push_back(*x);
  }
  return found;
}

/// The last value of a tuple of `components.NAME`; "-" if it was not published.
std::string value(const outputs& from, const std::string& key) {
  std::string text = "-";
  for (const auto& x : all<publish>(from)) {
    if (x.key == "components." + key)
      text = x.text;
  }
  return text;
}

bool has_notice(const outputs& from, const std::string& what) {
  return std::ranges::count(all<notice>(from), notice{what}) == 1;
}

byte_view octets(const std::string& x) {
  return {reinterpret_cast<const std::uint8_t*>(x.data()), x.size()};
}

/// A supervisor of one component that runs.
supervisor running(const component& what = program("camera")) {
  supervisor x({what});
  static_cast<void>(x.begin(instant{}));
  static_cast<void>(x.on_started(0, 1, 4711));
  REQUIRE(x.phase_of(0) == phase::on);
  return x;
}

/// Steps of a stop, and when they come.
std::vector<std::pair<duration, stop_step>> steps(supervisor& x, const outputs& first,
                                                  duration length) {
  std::vector<std::pair<duration, stop_step>> found;
  const auto add = [&](const outputs& from, instant now) {
    for (const auto& each : all<stop>(from))
      found.emplace_back(now.time_since_epoch(), each.step);
  };
  add(first, instant{});
  while (x.deadline() && *x.deadline() <= instant(length)) {
    const auto now = *x.deadline();
    add(x.on_time(now), now);
  }
  return found;
}

} // namespace

TEST_CASE("tuples describe every component from the beginning", "[peisinit][SVC-03]") {
  auto camera = program("camera");
  camera.semantics = "sees";
  camera.proxy = "(camera)";
  camera.arguments = "--fps 5";
  supervisor x({camera, peer("rules")});
  const auto out = x.begin(instant{});
  CHECK(std::get<publish>(out.front()) == publish{"components", "(camera rules)"});
  CHECK(value(out, "camera.reqState") == "on");
  CHECK(value(out, "camera.currState") == "starting");
  CHECK(value(out, "camera.id") == "31");
  CHECK(value(out, "camera.pid") == "0");
  CHECK(value(out, "camera.exec") == "exec camera $PEISINIT");
  CHECK(value(out, "camera.semantics") == "sees");
  CHECK(value(out, "camera.proxy") == "(camera)");
  CHECK(value(out, "camera.extra-arguments") == "--fps 5");
  CHECK(value(out, "camera.stdin").empty());
  CHECK(value(out, "camera.stdout").empty());
  CHECK(value(out, "camera.stderr").empty());
  CHECK(value(out, "rules.exec") == "peer rules");
  CHECK(all<start>(out) == std::vector{start{0, 1, "--fps 5"}, start{1, 1, ""}});

  const auto started = x.on_started(0, 1, 4711);
  CHECK(value(started, "camera.pid") == "4711");
  CHECK(value(started, "camera.currState") == "on");
  CHECK(has_notice(started, "camera on"));
}

TEST_CASE("on and off start and stop a component", "[peisinit][SVC-03]") {
  supervisor x({program("camera", false)});
  CHECK(all<start>(x.begin(instant{})).empty());
  CHECK(all<start>(x.on_request(0, "ON", instant{})) == std::vector{start{0, 1, ""}});
  CHECK(x.on_request(0, "on", instant{}).empty());
  static_cast<void>(x.on_started(0, 1, 1));
  CHECK(all<stop>(x.on_request(0, "off", instant{})) == std::vector{stop{0, stop_step::do_quit}});
  CHECK(x.on_request(0, "off", instant{}).empty());
  const auto ended = x.on_ended(0, 1, "status 0", instant(100ms));
  CHECK(value(ended, "camera.currState") == "off");
  CHECK(value(ended, "camera.pid") == "0");
  CHECK(has_notice(ended, "camera off"));
  CHECK_FALSE(x.deadline());
  CHECK(all<start>(x.on_request(0, "start", instant(1s))) == std::vector{start{0, 2, ""}});
}

TEST_CASE("what is no state is refused, counted and told", "[peisinit][SVC-03]") {
  auto x = running();
  const auto out = x.on_request(0, "of\nf", instant{});
  CHECK(has_notice(out, "camera refuses the state `of?f`"));
  CHECK(x.counted().refused == 1);
  CHECK(x.phase_of(0) == phase::on);
}

TEST_CASE("a component that ends by itself starts again after its delay", "[peisinit][SVC-04]") {
  auto what = program("camera");
  what.delay = 5s;
  auto x = running(what);
  const auto out = x.on_ended(0, 1, "signal 11", instant(10s));
  CHECK(value(out, "camera.currState") == "waiting");
  CHECK(has_notice(out, "camera has ended, signal 11, again in 5 s"));
  CHECK(x.deadline() == instant(15s));
  CHECK(x.on_request(0, "on", instant(11s)).empty()); // nobody is that important
  CHECK(all<start>(x.on_time(instant(15s) - 1ns)).empty());
  CHECK(all<start>(x.on_time(instant(15s))) == std::vector{start{0, 2, ""}});
  CHECK(x.on_ended(0, 1, "", instant(16s)).empty());                 // an old life
  static_cast<void>(x.on_ended(0, 2, "no such file", instant(16s))); // it never was on
  CHECK(x.deadline() == instant(21s));
  CHECK(value(x.on_request(0, "off", instant(17s)), "camera.currState") == "off");
  CHECK_FALSE(x.deadline());
  CHECK(x.counted().ends == 2);
}

TEST_CASE("a stop gets harder each half second", "[peisinit][SVC-05]") {
  auto x = running();
  const auto first = x.on_request(0, "off", instant{});
  CHECK(steps(x, first, 3s) ==
        std::vector<std::pair<duration, stop_step>>{{0s, stop_step::do_quit},
                                                    {500ms, stop_step::kernel_quit},
                                                    {1s, stop_step::interrupt},
                                                    {1500ms, stop_step::terminate},
                                                    {2s, stop_step::kill},
                                                    {2500ms, stop_step::kill},
                                                    {3s, stop_step::kill}});
  CHECK(x.counted().kills == 1);
  CHECK(x.phase_of(0) == phase::stopping);
}

TEST_CASE("a component is stopped while it starts", "[peisinit][SVC-05]") {
  supervisor x({program("camera")});
  static_cast<void>(x.begin(instant{}));
  static_cast<void>(x.on_request(0, "off", instant{}));
  CHECK(value(x.on_started(0, 1, 12), "camera.pid") == "12");
  CHECK(x.phase_of(0) == phase::stopping);
  static_cast<void>(x.on_ended(0, 1, "", instant(1s)));
  CHECK(x.phase_of(0) == phase::off);
}

TEST_CASE("abort kills at once, also in the middle of a stop", "[peisinit][SVC-05]") {
  auto x = running();
  CHECK(all<stop>(x.on_request(0, "abort", instant{})) == std::vector{stop{0, stop_step::kill}});
  auto y = running();
  static_cast<void>(y.on_request(0, "off", instant{}));
  CHECK(all<stop>(y.on_request(0, "abort", instant{})) == std::vector{stop{0, stop_step::kill}});
  const auto due = y.deadline();
  CHECK(all<stop>(y.on_request(0, "abort", instant{100ms})).empty()); // it is being killed
  CHECK(y.deadline() == due);
}

TEST_CASE("one that is wanted again while it stops starts when it has ended",
          "[peisinit][SVC-03]") {
  auto x = running();
  static_cast<void>(x.on_request(0, "off", instant{}));
  CHECK(all<start>(x.on_request(0, "on", instant{})).empty()); // never two
  CHECK(all<start>(x.on_ended(0, 1, "", instant(1s))) == std::vector{start{0, 2, ""}});
}

TEST_CASE("the last 4 kB of each output are a tuple", "[peisinit][SVC-03]") {
  auto x = running();
  CHECK(value(x.on_output(0, channel::out, octets("one\n"), instant(1s)), "camera.stdout") ==
        "one\n");
  CHECK(x.on_output(0, channel::out, octets("two\n"), instant(1s)).empty()); // not that often
  CHECK(x.on_output(0, channel::err, octets(std::string("a\0b", 3)), instant(1s)).empty());
  CHECK(x.deadline() == instant(1200ms));
  const auto later = x.on_time(instant(1200ms));
  CHECK(value(later, "camera.stdout") == "one\ntwo\n");
  CHECK(value(later, "camera.stderr") == "a?b");
  CHECK_FALSE(x.deadline());

  const std::string much(5000, 'x');
  CHECK(value(x.on_output(0, channel::out, octets(much), instant(2s)), "camera.stdout") ==
        std::string(4096, 'x'));
  static_cast<void>(x.on_output(0, channel::out, octets("last words"), instant(2s)));
  const auto ended = x.on_ended(0, 1, "", instant(2s));
  CHECK(value(ended, "camera.stdout") == std::string(4086, 'x') + "last words");
}

TEST_CASE("what is written to stdin is a line for the process", "[peisinit][SVC-03]") {
  auto x = running();
  CHECK(all<feed>(x.on_input(0, "go")) == std::vector{feed{0, "go\n"}});
  CHECK(all<feed>(x.on_input(0, "go\n")) == std::vector{feed{0, "go\n"}});
  CHECK(x.on_input(0, "").empty());
  static_cast<void>(x.on_ended(0, 1, "", instant{}));
  CHECK(has_notice(x.on_input(0, "go"), "camera refuses input"));
  auto y = running(peer("rules"));
  CHECK(has_notice(y.on_input(0, "go"), "rules refuses input"));
}

TEST_CASE("extra arguments count from the next start on", "[peisinit][SVC-03]") {
  supervisor x({program("camera", false)});
  static_cast<void>(x.begin(instant{}));
  CHECK(x.on_arguments(0, "--fps 7").empty());
  CHECK(has_notice(x.on_arguments(0, "a\nb"), "camera refuses arguments"));
  CHECK(has_notice(x.on_arguments(0, std::string(1001, 'a')), "camera refuses arguments"));
  CHECK(all<start>(x.on_request(0, "on", instant{})) == std::vector{start{0, 1, "--fps 7"}});
}

TEST_CASE("at the end all components are stopped before all are said to be off",
          "[peisinit][SVC-01]") {
  supervisor x({program("camera"), peer("rules"), program("arm"), program("lamp", false)});
  static_cast<void>(x.begin(instant{}));
  static_cast<void>(x.on_started(0, 1, 1));
  static_cast<void>(x.on_started(1, 1, 0));
  static_cast<void>(x.on_ended(2, 1, "", instant{})); // waits
  const auto out = x.shut_down(instant(1s));
  CHECK(all<stop>(out).size() == 2);
  CHECK(value(out, "arm.currState") == "off");
  CHECK(x.shut_down(instant(1s)).empty());
  CHECK(has_notice(x.on_request(3, "on", instant(1s)), "lamp refuses to start: all are to end"));
  CHECK(all<all_off>(x.on_ended(0, 1, "", instant(1100ms))).empty());
  const auto last = x.on_ended(1, 1, "", instant(1200ms));
  CHECK(all<all_off>(last).size() == 1);
  CHECK(has_notice(last, "all components are off"));

  supervisor none(std::vector<component>{});
  static_cast<void>(none.begin(instant{}));
  CHECK(all<all_off>(none.shut_down(instant{})).size() == 1);
}

TEST_CASE("a component's kernel is told who it is and whom to connect to", "[peisinit][SVC-02]") {
  const auto x = program("camera");
  CHECK(options_for(x, "", {"pc", "home", 8001}) ==
        "--peis-id 31 --peis-hostname pc --peis-network home --peis-connect tcp://localhost:8001");
  CHECK(options_for(x, "--fps 5", {"pc", "home", 0}) ==
        "--peis-id 31 --peis-hostname pc --peis-network home --fps 5");
}
