#include "io/process/isolated_process.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

using steady = std::chrono::steady_clock;

constexpr int child_socket = 3; ///< its descriptor in the copy

void set_limit(int what, rlim_t most) {
  const rlimit x{most, most};
  static_cast<void>(::setrlimit(static_cast<__rlimit_resource>(what), &x));
}

/// Octets of addresses that this process uses.
rlim_t used() {
  std::ifstream in("/proc/self/statm");
  rlim_t pages = 0;
  in >> pages;
  return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

/// A timer that kills this process, by the signal's default, when it has computed for so long.
void limit_processor(duration most) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(most).count();
  const itimerval x{{0, 0}, {us / 1'000'000, us % 1'000'000}};
  static_cast<void>(::setitimer(ITIMER_PROF, &x, nullptr));
}

/// What the copy does not take over: signals, files, the terminal.
void leave_host(int socket) {
  static_cast<void>(::setsid());
  for (const int each : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPROF, SIGSEGV, SIGABRT, SIGBUS,
                         SIGFPE, SIGILL, SIGPIPE, SIGCHLD})
    static_cast<void>(std::signal(each, SIG_DFL));
  sigset_t none;
  sigemptyset(&none);
  static_cast<void>(::sigprocmask(SIG_SETMASK, &none, nullptr));
  if (const int null = ::open("/dev/null", O_RDWR); null >= 0) { // NOLINT
    static_cast<void>(::dup2(null, STDIN_FILENO));
    static_cast<void>(::dup2(null, STDOUT_FILENO));
  }
  if (socket != child_socket)
    static_cast<void>(::dup2(socket, child_socket));
  static_cast<void>(
      ::close_range(child_socket + 1, std::numeric_limits<unsigned>::max(), 0)); // after the last
}

} // namespace

isolated_end::~isolated_end() {
  ::close(socket_);
}

bool isolated_end::send(byte_view message) const {
  for (;;) {
    const auto count = ::send(socket_, message.data(), message.size(), MSG_NOSIGNAL);
    if (count >= 0)
      return true;
    if (errno != EINTR)
      return false;
  }
}

bool isolated_end::receive(bytes& message) const {
  message.resize(most_.message_octets_max);
  for (;;) {
    const auto count = ::recv(socket_, message.data(), message.size(), 0);
    if (count < 0 && errno == EINTR)
      continue;
    message.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return count > 0;
  }
}

bool isolated_end::wait_until(steady::time_point end) const {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - steady::now());
    pollfd x{socket_, POLLIN, 0};
    const int ready = ::poll(&x, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready > 0)
      return true;
    if (ready == 0)
      return false;
    if (errno != EINTR)
      return true; // what comes next says why
  }
}

isolated_process::isolated_process(
    const isolation_limits& most,
    const std::function<void(isolated_end&, const std::function<void()>&)>& body)
    : most_(most) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw std::system_error(errno, std::generic_category(), "socketpair");
  const auto memory = used() + most.memory;
  pid_ = ::fork();
  if (pid_ == 0) {
    leave_host(ends[1]);
    set_limit(RLIMIT_AS, memory);
    set_limit(RLIMIT_CORE, 0);
    int status = 0;
    {
      isolated_end end(child_socket, most);
      try {
        limit_processor(most.processor);
        body(end, [&most] { limit_processor(most.processor); });
      } catch (const std::exception&) {
        status = 1;
      }
    }
    ::_exit(status);
  }
  const int error = errno;
  ::close(ends[1]);
  end_ = std::make_unique<isolated_end>(ends[0], most);
  if (pid_ < 0)
    throw std::system_error(error, std::generic_category(), "fork");
  begin_call();
}

isolated_process::~isolated_process() {
  if (pid_ < 0)
    return;
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) == -1 && errno == EINTR) {
  }
}

void isolated_process::begin_call() {
  until_ = steady::now() + most_.wall;
}

void isolated_process::send(byte_view message) {
  if (!end_->send(message))
    report_end();
}

bytes isolated_process::receive() {
  if (!end_->wait_until(until_))
    throw std::runtime_error("its process did not answer within " + to_text(most_.wall));
  bytes message;
  if (!end_->receive(message))
    report_end();
  return message;
}

/// Its end of the connection is closed, so it is about to end, or it is made to.
int isolated_process::collect() {
  constexpr int looks = 100;
  int how = 0;
  for (int i = 0; ::waitpid(pid_, &how, WNOHANG) == 0; ++i) {
    if (i == looks)
      ::kill(pid_, SIGKILL);
    ::usleep(10'000);
  }
  pid_ = -1;
  return how;
}

void isolated_process::report_end() {
  const int how = collect();
  if (WIFSIGNALED(how) && WTERMSIG(how) == SIGPROF)
    throw std::runtime_error("its process computed for more than " + to_text(most_.processor) +
                             " in one call");
  if (WIFSIGNALED(how))
    throw std::runtime_error(std::string("its process was ended by a signal: ") +
                             ::sigdescr_np(WTERMSIG(how)));
  throw std::runtime_error("its process has ended with status " + std::to_string(WEXITSTATUS(how)));
}

} // namespace rubicon::io
