#include "io/group_guard.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <memory>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

/// Negative: the group is over.
using message = std::int32_t;

constexpr int own_end = 3;

/// Those that are to die. Static: nothing may be allocated after the fork.
std::array<message, group_guard::groups_max> groups{};

void take(message x) noexcept {
  const message wanted = x > 0 ? 0 : -x; // a free place, or the group's
  for (auto& place : groups) {
    if (place == wanted) {
      place = x > 0 ? x : 0;
      return;
    }
  }
}

/// Nothing of the parent stays open: whoever reads its outputs sees their end when it ends.
void leave_parent(int from) noexcept {
  ::setsid(); // signals for the parent's group are not for the guard
  for (const int each : {SIGHUP, SIGINT, SIGTERM, SIGPIPE})
    ::signal(each, SIG_IGN);
  ::prctl(PR_SET_NAME, "rubicon-guard");
  const int nothing = ::open("/dev/null", O_RDWR);
  if (from != own_end)
    ::dup2(from, own_end);
  for (const int each : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    ::dup2(nothing, each);
  ::close_range(own_end + 1, ~0U, 0);
}

[[noreturn]] void guard(int from) noexcept {
  leave_parent(from);
  message x = 0;
  for (;;) {
    const auto size = ::recv(own_end, &x, sizeof x, MSG_WAITALL);
    if (size == sizeof x)
      take(x);
    else if (size != -1 || errno != EINTR)
      break;
  }
  for (const auto group : groups) {
    if (group > 0)
      ::kill(-group, SIGKILL);
  }
  ::_exit(0);
}

} // namespace

group_guard& group_guard::instance() {
  static std::unique_ptr<group_guard> only;
  if (!only || only->owner_ != ::getpid())
    only.reset(new group_guard);
  return *only;
}

group_guard::group_guard() : owner_(::getpid()) {
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return;
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  static_cast<void>(pthread_sigmask(SIG_SETMASK, &all, &before)); // our handlers are not for it
  pid_ = ::fork();
  if (pid_ == 0)
    guard(ends[1]);
  static_cast<void>(pthread_sigmask(SIG_SETMASK, &before, nullptr));
  ::close(ends[1]);
  to_ = ends[0];
}

group_guard::~group_guard() {
  if (to_ != -1)
    ::close(to_);
  while (pid_ > 0 && owner_ == ::getpid() && ::waitpid(pid_, nullptr, 0) == -1 && errno == EINTR) {
  }
}

void group_guard::add(pid_t group) const noexcept {
  const message x = group;
  static_cast<void>(::send(to_, &x, sizeof x, MSG_NOSIGNAL));
}

void group_guard::remove(pid_t group) const noexcept {
  const message x = -group;
  static_cast<void>(::send(to_, &x, sizeof x, MSG_NOSIGNAL));
}

} // namespace rubicon::io
