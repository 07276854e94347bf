#include "io/loop.hpp"

#include <cstdint>

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
  time_point armed_for;
  bool armed = false;
  bool outdated = false;    ///< the handler that just ran was that of a wait given up
  std::size_t own_runs = 0; ///< handlers run that are ours, not the users'

  void arm(time_point until) {
    if (armed && armed_for == until)
      return;
    timer.expires_at(until);
    timer.async_wait([this](const boost::system::error_code& error) {
      ++own_runs;
      if (error == asio::error::operation_aborted)
        outdated = true;
      else
        armed = false;
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
  impl_->arm(until);
  impl_->own_runs = 0;
  std::size_t runs = 0;
  do {
    impl_->outdated = false;
    runs += impl_->context.run_one();
  } while (impl_->outdated);
  runs += impl_->context.poll();
  return runs - impl_->own_runs;
}

void loop::wake() {
  asio::post(impl_->context, [this] { ++impl_->own_runs; });
}

asio::io_context& context_of(loop& x) {
  return x.inside().context;
}

} // namespace rubicon::io
