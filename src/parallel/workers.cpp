#include "parallel/workers.hpp"

#include <cassert>
#include <utility>

namespace rubicon::parallel {

namespace {

constexpr unsigned field_bits = 24;
constexpr std::uint64_t field_mask = (1U << field_bits) - 1;

/// Looks before a thread sleeps: some tens of microseconds.
constexpr int looks_max = 20'000;

std::uint64_t round_of(std::uint64_t state) {
  return state >> (2 * field_bits);
}

std::uint64_t count_of(std::uint64_t state) {
  return (state >> field_bits) & field_mask;
}

std::uint64_t next_of(std::uint64_t state) {
  return state & field_mask;
}

void look_again() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

} // namespace

workers::workers(unsigned others) {
  for (unsigned i = 0; i < others; ++i)
    threads_.emplace_back([this] { serve(); });
}

workers::~workers() {
  ending_.store(true);
  state_.store((round_of(state_.load()) + 1) << (2 * field_bits));
  state_.notify_all();
  for (auto& x : threads_)
    x.join();
}

void workers::run(std::size_t count, const std::function<void(std::size_t)>& job) {
  assert(count <= jobs_max);
  if (count == 0)
    return;
  job_ = &job;
  left_.store(count, std::memory_order_relaxed);
  const auto round = (round_of(state_.load(std::memory_order_relaxed)) + 1) & 0xffffU;
  state_.store(round << (2 * field_bits) | static_cast<std::uint64_t>(count) << field_bits,
               std::memory_order_release);
  state_.notify_all();
  take_jobs(round);
  for (int looks = 0;;) {
    const auto left = left_.load(std::memory_order_acquire);
    if (left == 0)
      break;
    if (++looks < looks_max)
      look_again();
    else
      left_.wait(left, std::memory_order_acquire);
  }
  const std::scoped_lock lock(failure_mutex_);
  if (failure_)
    std::rethrow_exception(std::exchange(failure_, nullptr));
}

void workers::serve() {
  for (std::uint64_t round = 0;;) {
    round = wait_for_round_after(round);
    if (ending_.load())
      return;
    take_jobs(round);
  }
}

std::uint64_t workers::wait_for_round_after(std::uint64_t round) const {
  for (int looks = 0;;) {
    const auto state = state_.load(std::memory_order_acquire);
    if (round_of(state) != round)
      return round_of(state);
    if (++looks < looks_max)
      look_again();
    else
      state_.wait(state, std::memory_order_acquire);
  }
}

void workers::take_jobs(std::uint64_t round) {
  for (auto state = state_.load(std::memory_order_acquire);;) {
    if (round_of(state) != round || next_of(state) >= count_of(state))
      return;
    if (!state_.compare_exchange_weak(state, state + 1, std::memory_order_acq_rel))
      continue;
    try {
      (*job_)(next_of(state));
    } catch (...) {
      const std::scoped_lock lock(failure_mutex_);
      if (!failure_)
        failure_ = std::current_exception();
    }
    if (left_.fetch_sub(1, std::memory_order_acq_rel) == 1)
      left_.notify_all();
    state = state_.load(std::memory_order_acquire);
  }
}

} // namespace rubicon::parallel
