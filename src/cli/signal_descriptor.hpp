// Signals that ask a command to end, for a loop around poll().
#pragma once

#include <cerrno>
#include <csignal>
#include <system_error>

#include <sys/signalfd.h>
#include <unistd.h>

namespace rubicon::cli {

/// SIGINT, SIGTERM and SIGHUP as a descriptor that poll() knows; they end the process again
/// afterwards.
class signal_descriptor {
public:
  signal_descriptor() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    if (struct sigaction how{};
        ::sigaction(SIGHUP, nullptr, &how) == 0 && how.sa_handler != SIG_IGN)
      sigaddset(&signals, SIGHUP);
    static_cast<void>(pthread_sigmask(SIG_BLOCK, &signals, &before_));
    descriptor_ = ::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
    if (descriptor_ == -1)
      throw std::system_error(errno, std::generic_category(), "no signal descriptor");
  }
  ~signal_descriptor() {
    static_cast<void>(take());
    ::close(descriptor_);
    static_cast<void>(pthread_sigmask(SIG_SETMASK, &before_, nullptr));
  }
  signal_descriptor(const signal_descriptor&) = delete;
  signal_descriptor& operator=(const signal_descriptor&) = delete;

  [[nodiscard]] int get() const { return descriptor_; }

  /// Whether a signal came since the last time.
  [[nodiscard]] bool take() const {
    signalfd_siginfo what{};
    return ::read(descriptor_, &what, sizeof what) == sizeof what;
  }

private:
  int descriptor_ = -1;
  sigset_t before_{};
};

} // namespace rubicon::cli
