// Short-lived programs of /bin/sh, and files that one of us may hold.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/files/file_lock.hpp"
#include "io/files/temporary_folder.hpp"
#include "io/loop.hpp"
#include "io/process/group_guard.hpp"
#include "io/process/process.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using io::process;

namespace {

/// A script, what it says, and how it ends.
struct script {
  io::loop loop;
  std::string out;
  std::string err;
  std::optional<io::process_end> end;
  std::vector<std::string> order;
  std::optional<process> running;

  explicit script(const std::string& text, std::vector<std::string> environment = {}) {
    auto made = process::start(
        loop, {"/bin/sh", {"sh", "-c", text}, std::move(environment)},
        {[this](process::output from, byte_view octets) {
           (from == process::output::out ? out : err).append(octets.begin(), octets.end());
           order.emplace_back("output");
         },
         [this](io::process_end how) {
           end = how;
           order.emplace_back("end");
         }});
    REQUIRE(std::holds_alternative<process>(made));
    running.emplace(std::get<process>(std::move(made)));
  }

  /// Lets things happen until `done` holds, for a minute at most.
  template <class Done>
  bool wait_for(Done done) {
    const auto latest = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!done() && std::chrono::steady_clock::now() < latest)
      loop.wait_until(latest);
    return done();
  }

  io::process_end wait() {
    REQUIRE(wait_for([this] { return end.has_value(); }));
    return *end;
  }
};

bool runs(pid_t x) {
  return ::kill(x, 0) == 0;
}

/// Also if nobody has collected its end yet.
bool is_gone(pid_t x) {
  int how = 0;
  static_cast<void>(::waitpid(x, &how, WNOHANG));
  return !runs(x) || !std::filesystem::exists("/proc/" + std::to_string(x) + "/exe");
}

} // namespace

TEST_CASE("a process says something on both outputs and ends", "[io][SVC-03]") {
  script x("echo good; echo bad >&2; exit 3");
  const auto pid = x.running->pid();
  CHECK(pid > 0);
  CHECK(x.wait() == io::process_end{3, 0});
  CHECK(io::to_string(*x.end) == "status 3");
  CHECK(x.out == "good\n");
  CHECK(x.err == "bad\n");
  CHECK(x.order.back() == "end");
  CHECK_FALSE(runs(pid)); // nor is it a zombie
  CHECK_FALSE(x.running->feed("too late\n"));
  x.running->signal(SIGTERM);
}

TEST_CASE("all that a process has said comes before its end", "[io][SVC-03]") {
  script x("i=0; while [ $i -lt 5000 ]; do echo 0123456789012345678; i=$((i+1)); done");
  CHECK(x.wait() == io::process_end{0, 0});
  CHECK(x.out.size() == 100'000);
}

TEST_CASE("a process reads what it is fed", "[io][SVC-03]") {
  script x("read a; echo got $a; read b; echo got $b");
  CHECK(x.running->feed("one\n"));
  REQUIRE(x.wait_for([&] { return x.out == "got one\n"; }));
  CHECK(x.running->feed("two\n"));
  CHECK(x.wait().status == 0);
  CHECK(x.out == "got one\ngot two\n");
}

TEST_CASE("input that nobody reads waits, up to a limit", "[io][SVC-03]") {
  script x("read go; cat | wc -c");
  std::size_t fed = 0;
  const std::string block(10'000, 'x');
  while (fed < 10'000'000 && x.running->feed(block))
    fed += block.size();
  CHECK(fed >= process::waiting_octets_max - block.size());
  CHECK(fed < 10'000'000);
  x.running->signal(SIGKILL);
  CHECK(x.wait() == io::process_end{-1, SIGKILL});
}

TEST_CASE("feeding a process that has closed its input harms nobody", "[io][SVC-03]") {
  script x("exec <&-; echo closed; while :; do :; done");
  REQUIRE(x.wait_for([&] { return x.out == "closed\n"; }));
  CHECK_FALSE(x.running->feed("anybody?\n"));
  x.running->signal(SIGKILL);
  CHECK(x.wait().signal == SIGKILL);
}

TEST_CASE("a process has the environment it is given", "[io][SVC-02]") {
  script x("echo $PEISINIT; echo ${PATH:+has a path}", {"PEISINIT=--peis-id 31 --fps 5"});
  CHECK(x.wait().status == 0);
  CHECK(x.out == "--peis-id 31 --fps 5\nhas a path\n");
}

TEST_CASE("signals come to all that a process has started", "[io][SVC-05]") {
  script x("trap 'echo caught; exit 5' TERM; sleep 1000 & echo $!; wait; wait");
  REQUIRE(x.wait_for([&] { return x.out.find('\n') != std::string::npos; }));
  const auto sleeper = static_cast<pid_t>(std::stol(x.out));
  CHECK(runs(sleeper));
  x.running->signal(SIGTERM);
  CHECK(x.wait() == io::process_end{5, 0});
  CHECK(x.out.find("caught") != std::string::npos);
}

TEST_CASE("what a process leaves behind ends with it", "[io][SVC-05]") {
  script x("trap '' INT TERM; sleep 1000 & echo $!");
  CHECK(x.wait().status == 0);
  const auto sleeper = static_cast<pid_t>(std::stol(x.out));
  const auto latest = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!is_gone(sleeper) && std::chrono::steady_clock::now() < latest) {
  }
  CHECK(is_gone(sleeper));
}

TEST_CASE("destroying a process kills it, also one that ignores all else", "[io][SVC-05]") {
  pid_t pid = 0;
  {
    script x("trap '' INT TERM HUP; echo ready; while :; do sleep 1000; done");
    REQUIRE(x.wait_for([&] { return x.out == "ready\n"; }));
    pid = x.running->pid();
    x.running->signal(SIGINT);
    x.running->signal(SIGTERM);
    x.loop.poll();
    CHECK(runs(pid));
    CHECK_FALSE(x.end);
    x.running.reset();
    x.loop.poll();
    CHECK_FALSE(x.end);
  }
  CHECK_FALSE(runs(pid));
}

TEST_CASE("processes and what they have started end with us, even if we are killed",
          "[io][SVC-05]") {
  int said[2] = {-1, -1};
  REQUIRE(::pipe(said) == 0);
  const auto us = ::fork();
  REQUIRE(us >= 0);
  if (us == 0) { // the process that is killed; its component ignores what can be ignored
    io::loop loop;
    std::string out;
    auto made = process::start(
        loop, {"/bin/sh", {"sh", "-c", "trap '' INT TERM HUP; sleep 1000 & echo $$ $!; wait"}},
        {[&](process::output, byte_view octets) { out.append(octets.begin(), octets.end()); },
         [](io::process_end) {}});
    while (out.find('\n') == std::string::npos)
      loop.wait_until(std::chrono::steady_clock::now() + std::chrono::seconds(1));
    static_cast<void>(::write(said[1], out.data(), out.size()));
    ::kill(::getpid(), SIGKILL);
  }
  ::close(said[1]);
  std::string text(100, '\0');
  const auto size = ::read(said[0], text.data(), text.size());
  REQUIRE(size > 0);
  ::close(said[0]);
  int how = 0;
  REQUIRE(::waitpid(us, &how, 0) == us);
  CHECK(WTERMSIG(how) == SIGKILL);
  const auto shell = static_cast<pid_t>(std::stol(text));
  const auto sleeper = static_cast<pid_t>(std::stol(text.substr(text.find(' '))));
  for (const auto each : {shell, sleeper}) {
    const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!is_gone(each) && std::chrono::steady_clock::now() < latest)
      ::usleep(1000);
    CHECK(is_gone(each));
    ::kill(each, SIGKILL);
  }
}

TEST_CASE("a guard that is killed is replaced, and guards what the first did", "[io][SVC-05]") {
  int said[2] = {-1, -1};
  REQUIRE(::pipe(said) == 0);
  const auto us = ::fork();
  REQUIRE(us >= 0);
  if (us == 0) {
    auto& guard = io::group_guard::instance();
    const io::temporary_folder folder("rubicon-test");
    std::ofstream(folder.path() / "kept").put('x');
    io::loop loop;
    std::string out;
    auto made = process::start(
        loop, {"/bin/sh", {"sh", "-c", "sleep 1000 & echo $!; wait"}},
        {[&](process::output, byte_view octets) { out.append(octets.begin(), octets.end()); },
         [](io::process_end) {}});
    while (out.find('\n') == std::string::npos)
      loop.wait_until(std::chrono::steady_clock::now() + std::chrono::seconds(1));
    for (int i = 0; i < 3; ++i) {
      const auto first = guard.pid();
      ::kill(first, SIGKILL);
      while (guard.pid() == first)
        ::usleep(1000);
    }
    out += folder.path().string();
    static_cast<void>(::write(said[1], out.data(), out.size()));
    ::kill(::getpid(), SIGKILL);
  }
  ::close(said[1]);
  std::string text(400, '\0');
  const auto size = ::read(said[0], text.data(), text.size());
  REQUIRE(size > 0);
  ::close(said[0]);
  text.resize(static_cast<std::size_t>(size));
  REQUIRE(::waitpid(us, nullptr, 0) == us);
  const auto sleeper = static_cast<pid_t>(std::stol(text));
  const std::filesystem::path folder = text.substr(text.find('\n') + 1);
  const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while ((!is_gone(sleeper) || std::filesystem::exists(folder)) &&
         std::chrono::steady_clock::now() < latest)
    ::usleep(1000);
  CHECK(is_gone(sleeper));
  CHECK(!std::filesystem::exists(folder));
  ::kill(sleeper, SIGKILL);
}

TEST_CASE("a process has the signals that programs expect", "[io][SVC-03]") {
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  script x("kill -PIPE $$; echo still here");
  const auto end = x.wait();
  std::signal(SIGPIPE, before);
  CHECK(end.signal == SIGPIPE);
  CHECK(x.out.empty());
}

TEST_CASE("a process inherits nothing but its inputs and outputs", "[io][SVC-03]") {
  const int ours = ::open("/dev/null", O_RDONLY); // without O_CLOEXEC, as sockets of Asio
  REQUIRE(ours > STDERR_FILENO);
  script x("test -e /proc/$$/fd/" + std::to_string(ours) + " && echo inherited");
  static_cast<void>(x.wait());
  ::close(ours);
  CHECK(x.out.empty());
}

TEST_CASE("several processes end each for itself", "[io][SVC-04]") {
  io::loop loop;
  std::vector<int> ended;
  std::vector<process> all;
  for (int i = 0; i < 8; ++i) {
    auto made = process::start(loop, {"/bin/sh", {"sh", "-c", "exit " + std::to_string(i)}},
                               {[](process::output, byte_view) {},
                                [&ended](io::process_end how) { ended.push_back(how.status); }});
    all.push_back(std::get<process>(std::move(made)));
  }
  const auto latest = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (ended.size() < 8 && std::chrono::steady_clock::now() < latest)
    loop.wait_until(latest);
  std::sort(ended.begin(), ended.end());
  CHECK(ended == std::vector{0, 1, 2, 3, 4, 5, 6, 7});
}

TEST_CASE("a program that does not exist cannot be started", "[io][SVC-04]") {
  io::loop loop;
  const auto made = process::start(loop, {"/nowhere/at-all", {"at-all"}}, {});
  REQUIRE(std::holds_alternative<std::string>(made));
  CHECK(std::get<std::string>(made).starts_with("/nowhere/at-all cannot be started"));
}

TEST_CASE("a file is held once, and says by whom", "[io][SVC-06]") {
  const auto path =
      (std::filesystem::temp_directory_path() / ("rubicon-lock-test-" + std::to_string(::getpid())))
          .string();
  {
    const auto first = io::file_lock::take(path);
    REQUIRE(std::holds_alternative<io::file_lock>(first));
    const auto second = io::file_lock::take(path);
    REQUIRE(std::holds_alternative<std::string>(second));
    CHECK(std::get<std::string>(second) ==
          path + " is held by process " + std::to_string(::getpid()));
  }
  CHECK(std::holds_alternative<io::file_lock>(io::file_lock::take(path)));
  std::filesystem::remove(path);
  CHECK(std::holds_alternative<std::string>(io::file_lock::take("/nowhere/at/all")));
}
