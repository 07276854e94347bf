#include "io/signal_watch.hpp"

#include <csignal>
#include <utility>

#include <boost/asio/signal_set.hpp>

#include "io/context.hpp"

namespace rubicon::io {

struct signal_watch::state {
  state(loop& where, callback f)
      : signals(context_of(where), SIGINT, SIGTERM), on_signal(std::move(f)) {}

  boost::asio::signal_set signals;
  callback on_signal;
};

signal_watch::signal_watch(loop& where, callback on_signal)
    : state_(std::make_shared<state>(where, std::move(on_signal))) {
  state_->signals.async_wait([x = state_](const boost::system::error_code& error, int signal) {
    if (error || !x->on_signal)
      return;
    x->signals.clear(); // gives the signals back their default action
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
