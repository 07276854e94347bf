#include "io/loop.hpp"

#include <cstdint>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"

namespace rubicon::io {

namespace asio = boost::asio;

struct loop::impl {
  asio::io_context context{1}; // one thread runs it; any may post
  asio::executor_work_guard<asio::io_context::executor_type> never_idle{context.get_executor()};
  asio::steady_timer timer{context}; // epoll alone rounds up to milliseconds, a timer does not
  time_point wanted;
  time_point armed_for;
  bool armed = false;
  bool too_early = false;   ///< the handler that just ran was the timer's, before `wanted`
  std::size_t own_runs = 0; ///< handlers run that are ours, not the users'

  /// A timer that is set for earlier stays: deadlines mostly move away, and setting costs more than
  /// a wake-up now and then.
  void arm(time_point until) {
    wanted = until;
    if (armed && armed_for <= until)
      return;
    timer.expires_at(until);
    timer.async_wait([this](const boost::system::error_code& error) {
      ++own_runs;
      if (error != asio::error::operation_aborted)
        armed = false;
      too_early = std::chrono::steady_clock::now() < wanted;
    });
    armed_for = until;
    armed = true;
  }
};

loop::loop() : impl_(std::make_unique<impl>()) {}

loop::~loop() = default;

std::size_t loop::poll() {
  impl_->own_runs = 0;
  return impl_->context.poll() - impl_->own_runs;
}

std::size_t loop::wait_until(time_point until) {
  if (until <= std::chrono::steady_clock::now())
    return poll();
  impl_->own_runs = 0;
  std::size_t runs = 0;
  do {
    impl_->arm(until);
    impl_->too_early = false;
    runs += impl_->context.run_one();
  } while (impl_->too_early);
  runs += impl_->context.poll();
  return runs - impl_->own_runs;
}

void loop::wake() {
  asio::post(impl_->context, [this] { ++impl_->own_runs; });
}

void loop::post(std::function<void()> f) {
  asio::post(impl_->context, std::move(f));
}

asio::io_context& context_of(loop& x) {
  return x.inside().context;
}

} // namespace rubicon::io
