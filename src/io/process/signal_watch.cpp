#include "io/process/signal_watch.hpp"

#include <csignal>
#include <utility>

#include <boost/asio/signal_set.hpp>

#include "io/context.hpp"

namespace rubicon::io {

namespace {

bool ignored_by_us = false; ///< SIGHUP

bool is_ignored(int signal) {
  struct sigaction how {};
  return ::sigaction(signal, nullptr, &how) == 0 && how.sa_handler == SIG_IGN;
}

} // namespace

struct signal_watch::state {
  state(loop& where, callback f, bool hangup_too)
      : signals(context_of(where), SIGINT, SIGTERM), on_signal(std::move(f)) {
    if (hangup_too && (ignored_by_us || !is_ignored(SIGHUP))) {
      signals.add(SIGHUP);
      hears_hangup = true;
    }
  }

  /// After the first signal: the others end the process again, but not SIGHUP.
  void give_back() {
    sigset_t hangup;
    sigset_t before;
    sigemptyset(&hangup);
    sigaddset(&hangup, SIGHUP);
    static_cast<void>(pthread_sigmask(SIG_BLOCK, &hangup, &before));
    signals.clear();
    if (hears_hangup) {
      static_cast<void>(::signal(SIGHUP, SIG_IGN));
      ignored_by_us = true;
    }
    static_cast<void>(pthread_sigmask(SIG_SETMASK, &before, nullptr));
  }

  boost::asio::signal_set signals;
  callback on_signal;
  bool hears_hangup = false;
};

signal_watch::signal_watch(loop& where, callback on_signal, bool hangup_too)
    : state_(std::make_shared<state>(where, std::move(on_signal), hangup_too)) {
  state_->signals.async_wait([x = state_](const boost::system::error_code& error, int signal) {
    if (error || !x->on_signal)
      return;
    x->give_back();
    std::exchange(x->on_signal, nullptr)(signal);
  });
}

signal_watch::~signal_watch() {
  // The pending handler keeps the state alive; it must neither hold the signals nor call back.
  state_->on_signal = nullptr;
  boost::system::error_code ignored;
  state_->signals.clear(ignored);
  state_->signals.cancel(ignored);
}

} // namespace rubicon::io
