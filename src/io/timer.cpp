#include "io/timer.hpp"

#include <cstdint>
#include <utility>

#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"

namespace rubicon::io {

struct timer::state : std::enable_shared_from_this<state> {
  explicit state(loop& where) : due(context_of(where)) {}

  boost::asio::steady_timer due;
  std::function<void()> then;
  std::uint64_t epoch = 0; ///< a call that is ready cannot be taken back otherwise

  void stop() {
    ++epoch;
    then = nullptr;
    due.cancel();
  }
};

timer::timer(loop& where) : state_(std::make_shared<state>(where)) {}

timer::~timer() {
  if (state_)
    state_->stop();
}

timer::timer(timer&&) noexcept = default;

void timer::start(duration length, std::function<void()> f) {
  state_->stop();
  state_->then = std::move(f);
  state_->due.expires_after(length);
  state_->due.async_wait([x = state_, epoch = state_->epoch](const boost::system::error_code&) {
    if (x->epoch == epoch)
      std::exchange(x->then, nullptr)();
  });
}

void timer::stop() {
  state_->stop();
}

} // namespace rubicon::io
