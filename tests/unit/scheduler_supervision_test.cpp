#include <cstdio>
#include <stdexcept>

#include <unistd.h>

#include "unit/scheduler_support.hpp"

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

using worker_actor = caf::typed_actor<caf::replies_to<mark>::with<int>>;

/// Throws at negative marks; `first` true: already when it is born.
worker_actor::behavior_type worker(traced_pointer<counted_state, worker_actor> self, bool quiet,
                                   bool stillborn) {
  if (quiet)
    tell_monitors_of_exceptions(self);
  if (stillborn)
    throw std::runtime_error("born dead");
  return {[](mark x) {
    if (x.value < 0)
      throw std::runtime_error("negative mark");
    if (x.value > 100)
      throw x.value;
    return x.value * 2;
  }};
}

struct supervisor_log {
  std::vector<std::string> reasons;
  std::vector<int> answers;
  std::vector<caf::error> errors;
};

/// Keeps one worker alive at path "worker" and passes marks on to it.
caf::behavior supervisor(caf::stateful_actor<worker_actor>* self, supervisor_log* log, bool quiet) {
  const auto start = [=](bool stillborn) {
    self->state = spawn_at<caf::monitored>(self, "worker", worker, quiet, stillborn);
  };
  self->set_down_handler([=](const caf::down_msg& x) {
    CHECK(x.source == self->state.address());
    log->reasons.push_back(self->system().render(x.reason));
    start(false);
  });
  start(log->reasons.empty() && !log->errors.empty());
  return {[=](mark x) {
    self->request(self->state, caf::infinite, x)
        .then([=](int y) { log->answers.push_back(y); },
              [=](const caf::error& y) { log->errors.push_back(y); });
  }};
}

} // namespace

TEST_CASE("a supervisor is told of an exception and restarts the one actor that threw it",
          "[scheduler][GEN-07]") {
  captured_stderr captured;
  supervisor_log log;
  {
    world world;
    const auto boss = world.system().spawn(supervisor, &log, true);
    for (const int i : {1, -1, 2, 101, 3}) {
      caf::anon_send(boss, mark{i});
      world.run_for(1ms);
      CHECK(counted_state::alive == 1);
    }
  }
  const auto printed = captured.text();
  CHECK(printed.empty());
  CHECK(counted_state::alive == 0);
  CHECK(log.answers == std::vector{2, 4, 6});
  REQUIRE(log.errors.size() == 2); // the requests in hand are answered
  CHECK(log.errors[0] == caf::sec::runtime_error);
  REQUIRE(log.reasons.size() == 2);
  CHECK(log.reasons[0].find("negative mark") != std::string::npos);
  CHECK(log.reasons[1].find("unknown exception") != std::string::npos);
}

TEST_CASE("a supervisor is told of an actor that fails in its behaviour function",
          "[scheduler][GEN-07]") {
  captured_stderr captured;
  supervisor_log log;
  log.errors.emplace_back(); // lets the first child be stillborn
  {
    world world;
    const auto boss = world.system().spawn(supervisor, &log, true);
    world.run_for(1ms);
    caf::anon_send(boss, mark{4});
    world.run_for(1ms);
  }
  const auto printed = captured.text();
  CHECK(printed.empty());
  REQUIRE(log.reasons.size() == 1);
  CHECK(log.reasons[0].find("born dead") != std::string::npos);
  CHECK(log.answers == std::vector{8});
}

TEST_CASE("an exception that nobody takes is printed to stderr at once", "[scheduler]") {
  captured_stderr captured;
  supervisor_log log;
  {
    world world;
    const auto boss = world.system().spawn(supervisor, &log, false);
    caf::anon_send(boss, mark{-1});
    world.run_for(1ms);
  }
  const auto printed = captured.text();
  CHECK(printed.find("unhandled exception") != std::string::npos);
  CHECK(printed.find("negative mark") != std::string::npos);
  CHECK(printed.back() == '\n');
  CHECK(log.reasons.size() == 1);
}

TEST_CASE("a message that nobody expects is printed to stderr", "[scheduler]") {
  captured_stderr captured;
  {
    world world;
    const auto deaf =
        world.system().spawn([](caf::event_based_actor*) -> caf::behavior { return {[](int) {}}; });
    caf::anon_send(deaf, mark{42});
    world.run_for(1ms);
  }
  CHECK(captured.text().find("mark(42)") != std::string::npos);
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
