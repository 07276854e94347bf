#include "scheduler/outside.hpp"

#include <utility>

#include "io/loop.hpp"

namespace rubicon::scheduler {

void outside::post(order x) {
  const std::scoped_lock lock(mutex_);
  orders_.push_back(std::move(x));
  waiting_.store(true, std::memory_order_relaxed);
  // One wake suffices: whoever takes the first order takes them all.
  if (orders_.size() == 1 && loop_ != nullptr)
    loop_->wake();
}

void outside::wake() {
  const std::scoped_lock lock(mutex_);
  if (loop_ != nullptr)
    loop_->wake();
}

std::vector<order> outside::take() {
  const std::scoped_lock lock(mutex_);
  waiting_.store(false, std::memory_order_relaxed);
  return std::exchange(orders_, {});
}

void outside::detach() {
  const std::scoped_lock lock(mutex_);
  loop_ = nullptr;
}

} // namespace rubicon::scheduler
