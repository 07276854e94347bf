#include "io/process/hangup_watch.hpp"

#include <csignal>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <boost/asio/signal_set.hpp>

#include "io/context.hpp"

namespace rubicon::io {

struct hangup_watch::state {
  state(loop& where, std::function<void()> f)
      : signals(context_of(where), SIGHUP), on_hangup(std::move(f)) {}

  static void wait(const std::shared_ptr<state>& x) {
    x->signals.async_wait([x](const boost::system::error_code& error, int) {
      if (error || !x->on_hangup)
        return;
      x->on_hangup();
      wait(x);
    });
  }

  boost::asio::signal_set signals;
  std::function<void()> on_hangup;
};

hangup_watch::hangup_watch(loop& where, std::function<void()> on_hangup)
    : state_(std::make_shared<state>(where, std::move(on_hangup))) {
  state::wait(state_);
}

hangup_watch::~hangup_watch() {
  state_->on_hangup = nullptr; // a pending handler keeps the state alive
  boost::system::error_code ignored;
  state_->signals.clear(ignored);
  state_->signals.cancel(ignored);
}

bool has_terminal() {
  const int terminal = ::open("/dev/tty", O_RDONLY | O_NOCTTY | O_CLOEXEC);
  if (terminal == -1)
    return false;
  ::close(terminal);
  return true;
}

} // namespace rubicon::io
