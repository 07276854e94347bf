#include "io/process/group_guard.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <utility>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

/// A group, negative if it is over; or a folder, behind `+` or, if it is to stay, `-`.
struct message {
  std::int32_t group = 0; ///< 0: a folder
  char folder[1 + group_guard::path_max + 1] = {};
};

constexpr int own_end = 3;

// Those that are to die. Static: nothing may be allocated after the fork.
std::array<std::int32_t, group_guard::groups_max> groups{};
std::array<message, group_guard::folders_max> folders{};

void take_group(std::int32_t x) noexcept {
  const auto group = std::abs(x);
  auto* place = std::ranges::find(groups, group);
  if (place == groups.end() && x > 0)
    place = std::ranges::find(groups, 0);
  if (place != groups.end())
    *place = std::max(x, 0);
}

void take_folder(const message& x) noexcept {
  const auto is_at = [](const char* path) {
    return [path](const message& each) { return std::strcmp(each.folder, path) == 0; };
  };
  auto* place = std::ranges::find_if(folders, is_at(x.folder + 1));
  if (place == folders.end() && x.folder[0] == '+')
    place = std::ranges::find_if(folders, is_at(""));
  if (place != folders.end())
    std::strcpy(place->folder, x.folder[0] == '+' ? x.folder + 1 : "");
}

message about(const std::string& folder, char what) {
  message x;
  x.folder[0] = what;
  folder.copy(x.folder + 1, group_guard::path_max);
  return x;
}

void send(int to, const message& x) noexcept {
  static_cast<void>(::send(to, &x, sizeof x, MSG_NOSIGNAL));
}

/// By another program: what is in a folder cannot be looked through without allocating.
void remove_folders() noexcept {
  ::timespec pause{0, 50'000'000}; // those that were killed may write a last time
  ::nanosleep(&pause, nullptr);
  for (const auto& each : folders) {
    if (each.folder[0] == '\0')
      continue;
    const auto child = ::fork();
    if (child == 0) {
      ::execl("/bin/rm", "rm", "-rf", "--", each.folder, nullptr);
      ::_exit(1);
    }
    ::waitpid(child, nullptr, 0);
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
  message x;
  for (;;) {
    const auto size = ::recv(own_end, &x, sizeof x, 0);
    if (size == sizeof x && x.group == 0)
      take_folder(x);
    else if (size == sizeof x)
      take_group(x.group);
    else if (size != -1 || errno != EINTR)
      break;
  }
  for (const auto group : groups) {
    if (group > 0)
      ::kill(-group, SIGKILL);
  }
  if (std::ranges::any_of(folders, [](const auto& each) { return each.folder[0] != '\0'; }))
    remove_folders();
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
  start();
  if (pid_ == -1)
    return;
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  static_cast<void>(pthread_sigmask(SIG_SETMASK, &all, &before)); // signals are for other threads
  watcher_ = std::thread([this] { watch(); });
  static_cast<void>(pthread_sigmask(SIG_SETMASK, &before, nullptr));
}

/// Makes a guard, which knows all that there is to guard.
void group_guard::start() {
  if (const int old = std::exchange(to_, -1); old != -1)
    ::close(old);
  pid_ = -1;
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
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
  for (const auto group : groups_)
    send(to_, {group, {}});
  for (const auto& folder : folders_)
    send(to_, about(folder, '+'));
}

/// Waits for the guard's end; unless it is ours too, makes another one.
void group_guard::watch() {
  constexpr auto pause = std::chrono::milliseconds(100); // not as fast as somebody can kill
  std::unique_lock lock(lock_);
  while (!ending_) {
    const auto guard = pid_;
    lock.unlock();
    while (guard > 0 && ::waitpid(guard, nullptr, 0) == -1 && errno == EINTR) {
    }
    lock.lock();
    if (ending_ || ends_.wait_for(lock, pause, [this] { return ending_; }))
      return;
    start();
  }
}

group_guard::~group_guard() {
  if (owner_ != ::getpid()) { // a copy of our parent's, whose thread is not here
    static_cast<void>(new std::thread(std::move(watcher_))); // NOLINT: so nobody waits for it
    if (to_ != -1)
      ::close(to_);
    return;
  }
  {
    const std::lock_guard lock(lock_);
    ending_ = true;
    if (to_ != -1)
      ::close(std::exchange(to_, -1));
  }
  ends_.notify_all();
  if (watcher_.joinable())
    watcher_.join();
}

void group_guard::add(pid_t group) const noexcept {
  send(to_, {group, {}});
}

void group_guard::keep(pid_t group) {
  const std::lock_guard lock(lock_);
  groups_.insert(group);
  send(to_, {group, {}});
}

void group_guard::remove(pid_t group) {
  const std::lock_guard lock(lock_);
  groups_.erase(group);
  send(to_, {-group, {}});
}

void group_guard::add_folder(const std::string& path) {
  if (path.size() > path_max)
    return;
  const std::lock_guard lock(lock_);
  folders_.insert(path);
  send(to_, about(path, '+'));
}

void group_guard::remove_folder(const std::string& path) {
  const std::lock_guard lock(lock_);
  if (folders_.erase(path) > 0)
    send(to_, about(path, '-'));
}

pid_t group_guard::pid() const {
  const std::lock_guard lock(lock_);
  return pid_;
}

} // namespace rubicon::io
