#include "io/loop.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/time.hpp"
#include "io/context.hpp"

namespace rubicon::io {

namespace asio = boost::asio;

namespace {

using clock = std::chrono::steady_clock;

/// Going to sleep and being woken costs about as much.
constexpr auto asking_max = 50us;
constexpr int gap_smoothing = 8;
constexpr std::size_t handlers_max = 64; // of one turn

} // namespace

struct loop::impl {
  asio::io_context context{1}; // one thread runs it; any may post
  asio::executor_work_guard<asio::io_context::executor_type> never_idle{context.get_executor()};
  asio::steady_timer timer{context}; // epoll alone rounds up to milliseconds, a timer does not
  time_point wanted;
  time_point armed_for;
  bool armed = false;
  bool too_early = false;   ///< the handler that just ran was the timer's, before `wanted`
  std::size_t own_runs = 0; ///< handlers run that are ours, not the users'
  clock::time_point last_ran;
  duration mean_gap = 1s; ///< between two turns that ran something

  /// Handlers that are ready, ours included: not all if there is no end of them, as while somebody
  /// sends faster than can be read.
  std::size_t run_ready() {
    own_runs = 0;
    return run_some();
  }

  std::size_t run_some() {
    std::size_t runs = 0;
    while (runs < handlers_max && context.poll_one() > 0)
      ++runs;
    return runs;
  }

  void note_ran(clock::time_point now) {
    mean_gap += (std::min<duration>(now - last_ran, 1ms) - mean_gap) / gap_smoothing;
    last_ran = now;
  }

  /// When to stop asking whether something is ready, and to sleep: at once, unless what comes is
  /// near.
  [[nodiscard]] clock::time_point asking_end(clock::time_point now, clock::time_point until) const {
    if (until - now <= asking_max)
      return until;
    return mean_gap < asking_max ? now + asking_max : now;
  }

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
      too_early = clock::now() < wanted;
    });
    armed_for = until;
    armed = true;
  }
};

loop::loop() : impl_(std::make_unique<impl>()) {}

loop::~loop() = default;

std::size_t loop::poll() {
  const auto all = impl_->run_ready();
  return all - impl_->own_runs;
}

std::size_t loop::wait_until(time_point until) {
  auto now = clock::now();
  if (until <= now)
    return poll();
  const auto end = impl_->asking_end(now, until);
  do {
    if (const auto all = impl_->run_ready()) {
      impl_->note_ran(now);
      return all - impl_->own_runs;
    }
    now = clock::now();
  } while (now < end);
  if (until <= now)
    return 0;
  impl_->own_runs = 0;
  std::size_t runs = 0;
  do {
    impl_->arm(until);
    impl_->too_early = false;
    runs += impl_->context.run_one();
  } while (impl_->too_early);
  runs += impl_->run_some();
  impl_->note_ran(clock::now());
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
