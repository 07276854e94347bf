// How runs and swarms end: by signals, by the end of what started them, with all that they have
// started themselves.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto patience = 20s; ///< more than any of this takes, on a machine with much to do

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// @returns whether it came to hold
template <class Condition>
bool eventually(Condition holds) {
  const auto latest = std::chrono::steady_clock::now() + patience;
  while (!holds()) {
    if (std::chrono::steady_clock::now() >= latest)
      return false;
    std::this_thread::sleep_for(5ms);
  }
  return true;
}

/// Also if nobody has collected its end.
bool is_gone(pid_t x) {
  return ::kill(x, 0) != 0 || !fs::exists("/proc/" + std::to_string(x) + "/exe");
}

std::vector<pid_t> children_of(pid_t x) {
  const auto id = std::to_string(x);
  std::ifstream stream("/proc/" + id + "/task/" + id + "/children");
  return {std::istream_iterator<pid_t>(stream), {}};
}

/// The binary with its outputs in a file; killed if it does not end by itself.
class started {
public:
  started(const std::vector<std::string>& words, const fs::path& output) {
    std::vector<char*> pointers;
    for (const auto& word : words)
      pointers.push_back(const_cast<char*>(word.c_str()));
    pointers.push_back(nullptr);
    pid_ = ::fork();
    REQUIRE(pid_ >= 0);
    if (pid_ != 0)
      return;
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none); // crashes are what is wanted here
    const int file = ::open(output.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
    ::execv(RUBICON_BINARY, pointers.data());
    ::_exit(127);
  }
  ~started() {
    if (pid_ == -1)
      return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  started(const started&) = delete;
  started& operator=(const started&) = delete;

  [[nodiscard]] pid_t pid() const { return pid_; }
  void signal(int number) const { ::kill(pid_, number); }

  /// As waitpid() tells it.
  int wait() {
    int how = 0;
    REQUIRE(eventually([&] { return ::waitpid(pid_, &how, WNOHANG) == pid_; }));
    pid_ = -1;
    return how;
  }

private:
  pid_t pid_ = -1;
};

/// A run in wall time with one component: a shell and what it has started, which both ignore all
/// that can be ignored.
class stubborn_run {
public:
  stubborn_run() {
    std::ofstream(folder_.path / "stubborn.toml") << R"(
[ecology]
name = "stubborn"
mode = "wall"
duration = "1h"

[[peer]]
id = 1
name = "pc"

[[peer.apps]]
app = "init"
lock = ")" << (folder_.path / "lock").string() << R"("
components = [{ name = "worker", id = 2, command = "trap '' INT TERM HUP; sleep 1000 & echo $$ $! >)"
                                                  << pids_file().string()
                                                  << R"(; while :; do sleep 1000; done" }]
)";
    run_.emplace(std::vector<std::string>{"rubicon", "run", "--log", "off",
                                          (folder_.path / "stubborn.toml").string()},
                 output_file());
    const bool is_up =
        eventually([&] { return text_of(pids_file()).find('\n') != std::string::npos; });
    CAPTURE(text_of(output_file()));
    REQUIRE(is_up);
    std::ifstream stream(pids_file());
    stream >> shell_ >> sleeper_;
    REQUIRE(!is_gone(shell_));
    REQUIRE(!is_gone(sleeper_));
  }
  ~stubborn_run() {
    run_.reset();
    for (const auto each : {shell_, sleeper_})
      if (each > 0)
        ::kill(each, SIGKILL);
  }

  [[nodiscard]] started& process() { return *run_; }
  [[nodiscard]] std::string output() const { return text_of(output_file()); }
  [[nodiscard]] bool leaves_nothing() const {
    return eventually([&] { return is_gone(shell_) && is_gone(sleeper_); });
  }

private:
  [[nodiscard]] fs::path pids_file() const { return folder_.path / "pids"; }
  [[nodiscard]] fs::path output_file() const { return folder_.path / "output"; }

  rubicon::test::scratch_folder folder_;
  std::optional<started> run_;
  pid_t shell_ = 0;
  pid_t sleeper_ = 0;
};

} // namespace

TEST_CASE("a signal ends a run, and its components with all they have started",
          "[cli][ACT-11][SVC-05]") {
  const int signal = GENERATE(SIGINT, SIGTERM, SIGHUP);
  CAPTURE(signal);
  stubborn_run x;
  x.process().signal(signal);
  const int how = x.process().wait();
  CAPTURE(x.output());
  REQUIRE(WIFEXITED(how));
  CHECK(WEXITSTATUS(how) == 130);
  CHECK(x.output().find("interrupted early") != std::string::npos);
  CHECK(x.leaves_nothing());
}

TEST_CASE("a terminal that goes away ends a run well, however often it says so", "[cli][ACT-11]") {
  stubborn_run x;
  x.process().signal(SIGHUP);
  std::this_thread::sleep_for(200ms); // the components are being stopped
  x.process().signal(SIGHUP);
  const int how = x.process().wait();
  REQUIRE(WIFEXITED(how));
  CHECK(WEXITSTATUS(how) == 130);
  CHECK(x.output().find("interrupted early") != std::string::npos);
  CHECK(x.leaves_nothing());
}

TEST_CASE("components end with a run that is killed or crashes", "[cli][SVC-05]") {
  const int signal = GENERATE(SIGKILL, SIGSEGV, SIGABRT, SIGQUIT);
  CAPTURE(signal);
  stubborn_run x;
  x.process().signal(signal);
  const int how = x.process().wait();
  CHECK_FALSE((WIFEXITED(how) && WEXITSTATUS(how) == 0)); // a sanitizer exits on a fault
  CHECK(x.leaves_nothing());
}

TEST_CASE("a second Ctrl-C ends a run at once, and its components", "[cli][ACT-11][SVC-05]") {
  stubborn_run x;
  x.process().signal(SIGINT);
  std::this_thread::sleep_for(200ms); // it has begun to end, which takes seconds
  x.process().signal(SIGINT);
  const int how = x.process().wait();
  CHECK((WIFSIGNALED(how) && WTERMSIG(how) == SIGINT));
  CHECK(x.leaves_nothing());
}

TEST_CASE("the runs of a swarm end with it, however it ends", "[cli][ACT-11]") {
  const int signal = GENERATE(SIGINT, SIGTERM, SIGHUP, SIGKILL);
  CAPTURE(signal);
  const rubicon::test::scratch_folder folder;
  started x({"rubicon", "swarm", "--seeds", "1..100", "--jobs", "2", "--for", "3650d", "--timeout",
             "1h", RUBICON_FIXTURES "/small.toml"},
            folder.path / "output");
  std::vector<pid_t> runs;
  REQUIRE(eventually([&] {
    runs = children_of(x.pid());
    return runs.size() == 2;
  }));
  x.signal(signal);
  const int how = x.wait();
  if (signal == SIGKILL) {
    CHECK(WIFSIGNALED(how));
  } else {
    REQUIRE(WIFEXITED(how));
    CHECK(WEXITSTATUS(how) == 130);
  }
  for (const auto each : runs)
    CHECK(eventually([&] { return is_gone(each); }));
}
