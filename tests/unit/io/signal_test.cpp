#include <chrono>
#include <csignal>
#include <memory>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "io/process/hangup_watch.hpp"
#include "io/process/signal_watch.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

bool has_default_action(int signal) {
  struct sigaction action {};
  ::sigaction(signal, nullptr, &action);
  return action.sa_handler == SIG_DFL;
}

} // namespace

TEST_CASE("the first signal calls back once, with its number", "[io][ACT-11]") {
  const int signal = GENERATE(SIGINT, SIGTERM, SIGHUP);
  io::loop loop;
  std::vector<int> seen;
  const io::signal_watch watch(loop, [&](int x) { seen.push_back(x); });
  CHECK(!has_default_action(SIGINT));
  CHECK(!has_default_action(SIGTERM));
  loop.poll();
  CHECK(seen.empty());
  std::raise(signal);
  loop.wait_until(std::chrono::steady_clock::now() + std::chrono::hours(1));
  CHECK(seen == std::vector{signal});
  CHECK(has_default_action(SIGINT));
  CHECK(has_default_action(SIGTERM));
}

TEST_CASE("the second signal ends the process", "[io][ACT-11]") {
  const auto child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    io::loop loop;
    bool called = false;
    const io::signal_watch watch(loop, [&](int) { called = true; });
    std::raise(SIGINT);
    loop.wait_until(std::chrono::steady_clock::now() + std::chrono::hours(1));
    if (!called)
      ::_exit(1);
    std::raise(SIGTERM);
    ::_exit(2);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGTERM);
}

TEST_CASE("a second SIGHUP does not hurry: terminals that go away send several", "[io][ACT-11]") {
  io::loop loop;
  int calls = 0;
  const io::signal_watch watch(loop, [&](int) { ++calls; });
  std::raise(SIGHUP);
  loop.wait_until(std::chrono::steady_clock::now() + std::chrono::hours(1));
  std::raise(SIGHUP); // would end this program
  loop.poll();
  CHECK(calls == 1);
}

TEST_CASE("a watch that is gone gives the signals back and stays silent", "[io][ACT-11]") {
  io::loop loop;
  int calls = 0;
  auto watch = std::make_unique<io::signal_watch>(loop, [&](int) { ++calls; });
  std::raise(SIGINT); // on its way when the watch goes
  watch.reset();
  CHECK(has_default_action(SIGINT));
  CHECK(has_default_action(SIGTERM));
  loop.poll();
  CHECK(calls == 0);
}

TEST_CASE("a watch may be destroyed by its own callback, and another may follow", "[io][ACT-11]") {
  io::loop loop;
  int calls = 0;
  for (int i = 1; i <= 2; ++i) {
    std::unique_ptr<io::signal_watch> watch;
    watch = std::make_unique<io::signal_watch>(loop, [&](int) {
      ++calls;
      watch.reset();
    });
    std::raise(SIGTERM);
    loop.wait_until(std::chrono::steady_clock::now() + std::chrono::hours(1));
    CHECK(calls == i);
    CHECK(watch == nullptr);
  }
}

TEST_CASE("each SIGHUP may mean that something is to be read again", "[io][ACT-10]") {
  io::loop loop;
  int again = 0;
  std::vector<int> seen;
  const auto wait = [&loop] {
    loop.wait_until(std::chrono::steady_clock::now() + std::chrono::hours(1));
  };
  auto hangups = std::make_unique<io::hangup_watch>(loop, [&] { ++again; });
  const io::signal_watch watch(
      loop, [&](int x) { seen.push_back(x); }, /*hangup_too=*/false);
  for (int i = 1; i <= 3; ++i) {
    std::raise(SIGHUP);
    wait();
    CHECK(again == i);
  }
  CHECK(seen.empty());
  std::raise(SIGTERM);
  wait();
  CHECK(seen == std::vector{SIGTERM});
  std::raise(SIGHUP); // on its way when the watch goes
  hangups.reset();
  loop.poll();
  CHECK(again == 3);
}
