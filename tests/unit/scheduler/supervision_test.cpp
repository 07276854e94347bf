#include <cstdio>
#include <stdexcept>

#include <unistd.h>

#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

namespace {

/// Catches what is written to stderr meanwhile.
class captured_stderr {
public:
  captured_stderr() : file_(std::tmpfile()), saved_(::dup(2)) { ::dup2(::fileno(file_), 2); }

  ~captured_stderr() {
    if (saved_ >= 0)
      text();
  }

  std::string text() {
    std::fflush(stderr);
    ::dup2(saved_, 2);
    ::close(saved_);
    saved_ = -1;
    std::rewind(file_);
    std::string result;
    for (int c = std::fgetc(file_); c != EOF; c = std::fgetc(file_))
      result.push_back(static_cast<char>(c));
    std::fclose(file_);
    return result;
  }

private:
  std::FILE* file_;
  int saved_;
};

/// Answers with the double. Throws at negative marks; `stillborn`: already when it is born.
mark_actor::behavior_type worker(counted_pointer self, mark_actor answers, bool stillborn) {
  if (stillborn)
    throw std::runtime_error("born dead");
  return {[self, answers](mark x) {
    if (x.value < 0)
      throw std::runtime_error("negative mark");
    if (x.value > 100)
      throw x.value;
    self->send(answers, mark{x.value * 2});
  }};
}

struct supervisor_log {
  std::vector<std::string> reasons;
  events answers;
};

struct supervisor_state {
  mark_actor child;
};
using supervisor_pointer = actor_pointer<supervisor_state, mark_actor>;

/// Keeps one worker alive at path "worker" and passes marks on to it.
mark_actor::behavior_type supervisor(supervisor_pointer self, supervisor_log* log,
                                     mark_actor answers, bool stillborn) {
  const auto start = [=](bool first) {
    self->state.child = spawn_at<monitored>(self, "worker", worker, answers, first && stillborn);
  };
  self->set_down_handler([=](const caf::down_msg& x) {
    CHECK(x.source == self->state.child.address());
    log->reasons.push_back(caf::to_string(x.reason));
    start(false);
  });
  start(true);
  return {[=](mark x) { self->send(self->state.child, x); }};
}

/// The reasons of the ends of those whom it monitors.
mark_actor::behavior_type mourner(mark_pointer self, std::vector<mark_actor> whom,
                                  std::vector<caf::error>* reasons) {
  self->set_down_handler([=](const caf::down_msg& x) { reasons->push_back(x.reason); });
  for (const auto& each : whom)
    self->monitor(each);
  return {[](mark) {}};
}

/// With what reason an actor ends that begins so and is sent mark{1}.
template <class Fun>
caf::error end_of(Fun fun) {
  world world;
  std::vector<caf::error> reasons;
  const auto doomed = world.spawn("doomed", fun);
  const auto monitor = world.spawn("", mourner, std::vector<mark_actor>{doomed}, &reasons);
  post_after(doomed, 1ms, mark{1});
  world.run_for(1s);
  CHECK(doomed.get().has_ended());
  CHECK(counted_state::alive == 0);
  REQUIRE(reasons.size() == 1);
  return reasons[0];
}

std::string text_of(const caf::error& x) {
  return caf::to_string(x);
}

} // namespace

TEST_CASE("a supervisor is notified of an exception and restarts the one actor that threw it",
          "[scheduler][GEN-07]") {
  captured_stderr captured;
  supervisor_log log;
  {
    world world;
    const auto answers = world.spawn("", recorder, &log.answers, 0);
    const auto boss = world.spawn("", supervisor, &log, answers, false);
    for (const int i : {1, -1, 2, 101, 3}) {
      post(boss, mark{i});
      world.run_for(1ms);
      CHECK(counted_state::alive == 1);
    }
  }
  const auto printed = captured.text();
  CHECK(printed.empty());
  CHECK(counted_state::alive == 0);
  CHECK(log.answers == events{{0s, 2}, {2ms, 4}, {4ms, 6}});
  REQUIRE(log.reasons.size() == 2);
  CHECK(log.reasons[0].find("negative mark") != std::string::npos);
  CHECK(log.reasons[1].find("unknown exception") != std::string::npos);
}

TEST_CASE("a supervisor is notified of an actor that fails in its behaviour function",
          "[scheduler][GEN-07]") {
  captured_stderr captured;
  supervisor_log log;
  {
    world world;
    const auto answers = world.spawn("", recorder, &log.answers, 0);
    const auto boss = world.spawn("", supervisor, &log, answers, true);
    world.run_for(1ms);
    post(boss, mark{4});
    world.run_for(1ms);
  }
  const auto printed = captured.text();
  CHECK(printed.empty());
  REQUIRE(log.reasons.size() == 1);
  CHECK(log.reasons[0].find("born dead") != std::string::npos);
  CHECK(log.answers == events{{1ms, 8}});
}

TEST_CASE("an exception ends an actor, whatever throws it", "[scheduler][GEN-07]") {
  SECTION("a handler") {
    const auto x = end_of([](counted_pointer) -> mark_actor::behavior_type {
      return {[](mark) { throw std::runtime_error("in the handler"); }};
    });
    CHECK(x == caf::sec::runtime_error);
    CHECK(text_of(x).find("in the handler") != std::string::npos);
  }
  SECTION("the behaviour function") {
    const auto x = end_of([](counted_pointer self) -> mark_actor::behavior_type {
      if (self->state.friend_of_mine == nullptr)
        throw std::runtime_error("in the beginning");
      return {[](mark) { FAIL("it has not begun"); }};
    });
    CHECK(text_of(x).find("in the beginning") != std::string::npos);
  }
  SECTION("the exception handler itself") {
    const auto x = end_of([](counted_pointer self) -> mark_actor::behavior_type {
      self->set_exception_handler([](std::exception_ptr&) -> caf::error {
        throw std::runtime_error("in the last resort");
      });
      return {[](mark) { throw std::runtime_error("in the handler"); }};
    });
    CHECK(text_of(x).find("in the last resort") != std::string::npos);
  }
  SECTION("the exit handler") {
    const auto x = end_of([](counted_pointer self) -> mark_actor::behavior_type {
      self->set_exit_handler(
          [](const caf::exit_msg&) { throw std::runtime_error("in the exit handler"); });
      return {[self](mark) {
        self->send_exit(self->handle(), caf::make_error(caf::exit_reason::user_shutdown));
      }};
    });
    CHECK(text_of(x).find("in the exit handler") != std::string::npos);
  }
  SECTION("the down handler") {
    const auto x = end_of([](counted_pointer self) -> mark_actor::behavior_type {
      self->set_down_handler(
          [](const caf::down_msg&) { throw std::runtime_error("in the down handler"); });
      spawn_at<monitored>(self, "child", [](counted_pointer child) -> mark_actor::behavior_type {
        child->quit();
        return {[](mark) {}};
      });
      return {[](mark) { FAIL("it has ended"); }};
    });
    CHECK(text_of(x).find("in the down handler") != std::string::npos);
  }
}

TEST_CASE("an exception handler makes the reason of the end", "[scheduler][GEN-07]") {
  const auto x = end_of([](counted_pointer self) -> mark_actor::behavior_type {
    self->set_exception_handler(
        [](std::exception_ptr&) { return caf::make_error(caf::sec::bad_function_call); });
    return {[](mark) { throw std::runtime_error("in the handler"); }};
  });
  CHECK(x == caf::sec::bad_function_call);
}

TEST_CASE("who quits ends after what it is doing, with its reason or none", "[scheduler]") {
  int after = 0;
  const auto quits = [&after](const caf::error& reason) {
    return end_of([&after, reason](counted_pointer self) -> mark_actor::behavior_type {
      return {[&after, reason, self](mark) {
        self->send(self, mark{2}); // which it does not live to see
        self->quit(reason);
        ++after;
      }};
    });
  };
  CHECK(!quits({}));
  CHECK(quits(caf::make_error(caf::exit_reason::user_shutdown)) == caf::exit_reason::user_shutdown);
  CHECK(after == 2);
}

TEST_CASE("all who monitor an actor are notified of its end once, and who comes late at once",
          "[scheduler]") {
  world world;
  std::vector<caf::error> first;
  std::vector<caf::error> second;
  std::vector<caf::error> late;
  const auto doomed = world.spawn("", mute);
  const std::vector<mark_actor> whom{doomed};
  const auto one = world.spawn("", mourner, whom, &first);
  const auto two = world.spawn("", mourner, whom, &second);
  const auto deaf = world.spawn("", [whom](mark_pointer self) -> mark_actor::behavior_type {
    self->monitor(whom[0]); // without a handler nothing is done
    return {[](mark) {}};
  });
  world.run_for(1ms);
  post_exit(doomed, caf::exit_reason::kill);
  world.run_for(1ms);
  const auto three = world.spawn("", mourner, whom, &late);
  world.run_for(1ms);
  for (const auto* each : {&first, &second, &late}) {
    REQUIRE(each->size() == 1);
    CHECK((*each)[0] == caf::exit_reason::kill);
  }
  CHECK(!deaf.get().has_ended());
}

TEST_CASE("an exit handler is asked before the end, unless somebody kills", "[scheduler][ACT-11]") {
  world world;
  std::vector<caf::error> asked;
  const auto stubborn = world.spawn("", [&](counted_pointer self) -> mark_actor::behavior_type {
    self->set_exit_handler([&asked](const caf::exit_msg& x) { asked.push_back(x.reason); });
    return {[](mark) {}};
  });
  const auto meek = world.spawn("", mute);
  for (const auto& x : {stubborn, meek}) {
    post_exit(x, caf::exit_reason::normal); // who ends in good order takes none along
    world.run_for(1ms);
    CHECK(!x.get().has_ended());
    post_exit(x, caf::exit_reason::user_shutdown);
    world.run_for(1ms);
  }
  CHECK(!stubborn.get().has_ended());
  CHECK(meek.get().has_ended());
  CHECK(counted_state::alive == 1);
  post_exit(stubborn, caf::exit_reason::kill);
  world.run_for(1ms);
  CHECK(stubborn.get().has_ended());
  CHECK(counted_state::alive == 0);
  REQUIRE(asked.size() == 2);
  CHECK(!asked[0]);
  CHECK(asked[1] == caf::exit_reason::user_shutdown);
}

TEST_CASE("no threads are started for an actor system", "[scheduler][GEN-07]") {
  const auto threads = [] {
    int count = 0;
    if (auto* status = std::fopen("/proc/self/status", "r")) {
      char line[256];
      while (std::fgets(line, sizeof line, status) != nullptr)
        if (std::sscanf(line, "Threads: %d", &count) == 1)
          break;
      std::fclose(status);
    }
    return count;
  };
  const auto before = threads();
  REQUIRE(before > 0);
  world world;
  world.run_for(1s);
  CHECK(threads() == before);
}
