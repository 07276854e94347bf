#include "cli/child_process.hpp"

#include <array>
#include <cassert>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace rubicon::cli {

namespace {

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

/// Both ends, not inherited by children and never waiting at the end that is read.
std::array<int, 2> open_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    fail(errno, "no pipe");
  static_cast<void>(::fcntl(ends[0], F_SETFL, O_NONBLOCK));
  return ends;
}

/// Where its inputs and outputs go, and that signals blocked here are not blocked there.
class spawn_plan {
public:
  spawn_plan(int out, int err) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, err, STDERR_FILENO);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK);
  }
  ~spawn_plan() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  spawn_plan(const spawn_plan&) = delete;
  spawn_plan& operator=(const spawn_plan&) = delete;

  /// @returns the error, or 0
  int start(pid_t& pid, const std::string& program, const std::vector<std::string>& words) const {
    std::vector<char*> arguments;
    for (const auto& word : words)
      arguments.push_back(const_cast<char*>(word.c_str())); // as exec wants it; it changes nothing
    arguments.push_back(nullptr);
    return ::posix_spawn(&pid, program.c_str(), &actions_, &attributes_, arguments.data(), environ);
  }

private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

} // namespace

child_process::child_process(const std::string& program, const std::vector<std::string>& words) {
  const auto out = open_pipe();
  out_.descriptor = out[0];
  std::array<int, 2> err{};
  try {
    err = open_pipe();
  } catch (const std::system_error&) {
    ::close(out[1]);
    close(out_);
    throw;
  }
  err_.descriptor = err[0];
  const auto error = spawn_plan(out[1], err[1]).start(pid_, program, words);
  ::close(out[1]);
  ::close(err[1]);
  if (error != 0) {
    pid_ = -1;
    close(out_);
    close(err_);
    fail(error, program + " cannot be started");
  }
}

child_process::child_process(child_process&& x) noexcept
    : pid_(std::exchange(x.pid_, -1)), out_(std::exchange(x.out_, {})),
      err_(std::exchange(x.err_, {})), overlong_(x.overlong_) {}

child_process::~child_process() {
  if (pid_ == -1)
    return;
  kill();
  static_cast<void>(wait());
}

std::vector<int> child_process::descriptors() const {
  std::vector<int> open;
  for (const auto* x : {&out_, &err_}) {
    if (x->descriptor != -1)
      open.push_back(x->descriptor);
  }
  return open;
}

void child_process::close(output& x) {
  if (x.descriptor != -1)
    ::close(std::exchange(x.descriptor, -1));
}

bool child_process::read_block(output& from) {
  std::array<char, 65536> block{};
  const auto size = ::read(from.descriptor, block.data(), block.size());
  if (size < 0)
    return errno == EAGAIN || errno == EINTR;
  from.text.append(block.data(), static_cast<std::size_t>(size));
  return size > 0;
}

void child_process::read() {
  if (out_.descriptor != -1 && !read_block(out_))
    close(out_);
  if (err_.descriptor != -1 && !read_block(err_))
    close(err_);
  if (err_.text.size() > err_octets_max)
    err_.text.erase(0, err_.text.size() - err_octets_max);
  if (out_.text.size() > out_octets_max) {
    overlong_ = true;
    kill(); // first: a closed pipe would end it too
    close(out_);
  }
}

void child_process::kill() const {
  if (pid_ != -1)
    ::kill(pid_, SIGKILL);
}

child_end child_process::wait() {
  assert(pid_ != -1);
  int how = 0;
  while (::waitpid(pid_, &how, 0) == -1 && errno == EINTR) {
  }
  pid_ = -1;
  close(out_);
  close(err_);
  child_end x{-1, 0, std::move(out_.text), std::move(err_.text), overlong_};
  if (WIFEXITED(how))
    x.status = WEXITSTATUS(how);
  else if (WIFSIGNALED(how))
    x.signal = WTERMSIG(how);
  return x;
}

} // namespace rubicon::cli
