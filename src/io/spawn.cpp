#include "io/spawn.hpp"

#include <cerrno>
#include <csignal>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

extern char** environ;

namespace rubicon::io {

namespace {

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

/// A descriptor that is closed unless it is taken.
class descriptor {
public:
  descriptor() = default;
  explicit descriptor(int number) : number_(number) {}
  ~descriptor() {
    if (number_ != -1)
      ::close(number_);
  }
  descriptor(descriptor&& x) noexcept : number_(x.take()) {}
  descriptor& operator=(descriptor&&) = delete;

  [[nodiscard]] int get() const { return number_; }
  [[nodiscard]] int take() { return std::exchange(number_, -1); }

private:
  int number_ = -1;
};

struct pipe_ends {
  descriptor ours;
  descriptor theirs;
};

/// Neither end is inherited, and ours never waits.
pipe_ends open_pipe(bool we_read) {
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0)
    fail(errno, "no pipe");
  const int ours = ends[we_read ? 0 : 1];
  static_cast<void>(::fcntl(ours, F_SETFL, O_NONBLOCK));
  return {descriptor(ours), descriptor(ends[we_read ? 1 : 0])};
}

std::vector<char*> pointers_to(const std::vector<std::string>& words) {
  std::vector<char*> found;
  for (const auto& word : words)
    found.push_back(const_cast<char*>(word.c_str())); // as exec wants it; it changes nothing
  found.push_back(nullptr);
  return found;
}

/// Ours, with those that are given in the place of ours of the same name.
std::vector<std::string> environment_with(const std::vector<std::string>& given) {
  auto all = given;
  for (auto** each = environ; each != nullptr && *each != nullptr; ++each) {
    const std::string_view ours(*each);
    const auto name = ours.substr(0, ours.find('=') + 1);
    bool replaced = false;
    for (const auto& x : given)
      replaced = replaced || (!name.empty() && x.starts_with(name));
    if (!replaced)
      all.emplace_back(ours);
  }
  return all;
}

/// Where its inputs and outputs go, its group, and that signals blocked here are not blocked there.
class spawn_plan {
public:
  spawn_plan(int in, int out, int err, bool own_group) {
    posix_spawn_file_actions_init(&actions_);
    if (in == -1)
      posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    else
      posix_spawn_file_actions_adddup2(&actions_, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, err, STDERR_FILENO);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(
        &attributes_,
        static_cast<short>(POSIX_SPAWN_SETSIGMASK | (own_group ? POSIX_SPAWN_SETPGROUP : 0)));
  }
  ~spawn_plan() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  spawn_plan(const spawn_plan&) = delete;
  spawn_plan& operator=(const spawn_plan&) = delete;

  /// @returns the error, or 0
  int start(pid_t& pid, const spawn_request& x) const {
    const auto environment = environment_with(x.environment);
    return ::posix_spawn(&pid, x.program.c_str(), &actions_, &attributes_,
                         pointers_to(x.words).data(), pointers_to(environment).data());
  }

private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

} // namespace

spawned spawn(const spawn_request& x) {
  auto in = x.feeds ? open_pipe(false) : pipe_ends{};
  auto out = open_pipe(true);
  auto err = open_pipe(true);
  spawned made;
  const spawn_plan plan(in.theirs.get(), out.theirs.get(), err.theirs.get(), x.own_group);
  if (const int error = plan.start(made.pid, x); error != 0)
    fail(error, x.program + " cannot be started");
  made.in = in.ours.take();
  made.out = out.ours.take();
  made.err = err.ours.take();
  return made;
}

} // namespace rubicon::io
