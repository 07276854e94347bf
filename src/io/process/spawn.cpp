#include "io/process/spawn.hpp"

#include <cerrno>
#include <csignal>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/descriptor.hpp"
#include "io/process/group_guard.hpp"

extern char** environ;

namespace rubicon::io {

namespace {

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

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

/// What a child needs to become another program, made before the fork: after it nothing may be
/// allocated, since another thread may have held the allocator's lock.
class spawn_plan {
public:
  spawn_plan(const spawn_request& x, int in, int out, int err)
      : program_(x.program), words_(x.words), environment_(environment_with(x.environment)),
        word_pointers_(pointers_to(words_)), environment_pointers_(pointers_to(environment_)),
        folder_(x.folder), in_(in), out_(out), err_(err), own_group_(x.own_group) {
    if (own_group_)
      guard_ = &group_guard::instance();
  }

  /// @throws std::system_error
  [[nodiscard]] pid_t start() const {
    auto failure = open_pipe(true); // the child's exec closes it, or writes what went wrong
    const pid_t parent = ::getpid();
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    static_cast<void>(pthread_sigmask(SIG_SETMASK, &all, &before)); // handlers are the parent's
    const pid_t child = ::fork();
    if (child == 0)
      become(parent, failure.theirs.get());
    const int error = errno;
    static_cast<void>(pthread_sigmask(SIG_SETMASK, &before, nullptr));
    if (child == -1)
      fail(error, program_ + " cannot be started");
    failure.theirs.close();
    if (own_group_)
      guard_->keep(child);
    await_exec(child, failure.ours.get());
    return child;
  }

private:
  [[noreturn]] void become(pid_t parent, int failure) const noexcept {
    // The parent may have died before we asked for the signal: then we have another parent now.
    if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != parent)
      ::_exit(exec_failed);
    if (own_group_) {
      static_cast<void>(::setpgid(0, 0));
      guard_->add(::getpid());
    }
    const int in = in_ == -1 ? ::open("/dev/null", O_RDONLY | O_CLOEXEC) : in_;
    ::dup2(in, STDIN_FILENO);
    ::dup2(out_, STDOUT_FILENO);
    ::dup2(err_, STDERR_FILENO);
    reset_signals();
    if (!folder_.empty() && ::chdir(folder_.c_str()) != 0)
      give_up(failure);
    // Sockets above all: one that lives on in a child is not closed when we close it.
    ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    ::execve(program_.c_str(), word_pointers_.data(), environment_pointers_.data());
    give_up(failure);
  }

  /// Reports the last error to the parent.
  [[noreturn]] static void give_up(int failure) noexcept {
    const int error = errno;
    static_cast<void>(::write(failure, &error, sizeof error));
    ::_exit(exec_failed);
  }

  /// As a program expects them that a shell has started: no handlers, nothing blocked, and writing
  /// into a broken pipe ends it, whatever this process does with the signal. SIGHUP and the like
  /// stay ignored if they were (nohup).
  static void reset_signals() noexcept {
    for (int each = 1; each < NSIG; ++each) {
      struct sigaction how {};
      if (::sigaction(each, nullptr, &how) != 0)
        continue;
      const bool is_ignored = how.sa_handler == SIG_IGN;
      if (how.sa_handler == SIG_DFL || (is_ignored && each != SIGPIPE && each != SIGXFSZ))
        continue;
      how.sa_handler = SIG_DFL;
      how.sa_flags = 0;
      static_cast<void>(::sigaction(each, &how, nullptr));
    }
    sigset_t none;
    sigemptyset(&none);
    static_cast<void>(pthread_sigmask(SIG_SETMASK, &none, nullptr));
  }

  void await_exec(pid_t child, int from) const {
    static_cast<void>(::fcntl(from, F_SETFL, 0)); // waits
    int error = 0;
    ssize_t size = 0;
    do
      size = ::read(from, &error, sizeof error);
    while (size == -1 && errno == EINTR);
    if (size != sizeof error)
      return;
    if (own_group_)
      guard_->remove(child);
    while (::waitpid(child, nullptr, 0) == -1 && errno == EINTR) {
    }
    fail(error, program_ + " cannot be started");
  }

  static constexpr int exec_failed = 127;

  std::string program_;
  std::vector<std::string> words_;
  std::vector<std::string> environment_;
  std::vector<char*> word_pointers_;
  std::vector<char*> environment_pointers_;
  std::string folder_;
  int in_;
  int out_;
  int err_;
  bool own_group_;
  group_guard* guard_ = nullptr;
};

} // namespace

spawned spawn(const spawn_request& x) {
  auto in = x.feeds ? open_pipe(false) : pipe_ends{};
  auto out = open_pipe(true);
  auto err = open_pipe(true);
  spawned made;
  made.pid = spawn_plan(x, in.theirs.get(), out.theirs.get(), err.theirs.get()).start();
  made.in = in.ours.take();
  made.out = out.ours.take();
  made.err = err.ours.take();
  return made;
}

} // namespace rubicon::io
