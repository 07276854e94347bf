// Threads that share the jobs of short rounds.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace rubicon::parallel {

/// A round is as short as some microseconds, so whoever waits for the next first looks for a while
/// before it sleeps.
class workers {
public:
  static constexpr std::size_t jobs_max = (1U << 24U) - 1;

  /// @param others threads besides the one that calls run()
  explicit workers(unsigned others);
  ~workers();
  workers(const workers&) = delete;
  workers& operator=(const workers&) = delete;

  /// Calls job(0) .. job(count - 1), in any order and at the same time, and returns when all have
  /// returned. What one of them throws is thrown here. Calls are for one thread at a time.
  /// @pre count <= jobs_max
  void run(std::size_t count, const std::function<void(std::size_t)>& job);

private:
  void serve();
  void take_jobs(std::uint64_t round);
  [[nodiscard]] std::uint64_t wait_for_round_after(std::uint64_t round) const;

  /// The number of the round (16 bits), how many jobs it has (24), and which is next (24): in one
  /// word, so that nobody takes a job of another round than it thinks.
  std::atomic<std::uint64_t> state_ = 0;
  std::atomic<std::size_t> left_ = 0; ///< jobs of this round that have not returned
  std::atomic<bool> ending_ = false;
  const std::function<void(std::size_t)>* job_ = nullptr; ///< set before state_
  std::mutex failure_mutex_;
  std::exception_ptr failure_; ///< the first of this round; guarded by failure_mutex_
  std::vector<std::thread> threads_;
};

} // namespace rubicon::parallel
