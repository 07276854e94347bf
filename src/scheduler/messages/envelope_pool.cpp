#include "scheduler/messages/envelope_pool.hpp"

#include <new>

namespace rubicon::scheduler {

envelope_pool::~envelope_pool() {
  for (auto& list : free_) {
    while (list.first != nullptr) {
      auto* const block = list.first;
      list.first = block->next;
      ::operator delete(block);
    }
  }
}

void* envelope_pool::take(std::size_t size) {
  const auto number = (size - 1) / step;
  if (number >= sizes)
    return ::operator new(size);
  if (current != nullptr) {
    auto& list = current->free_[number];
    if (auto* const block = list.first; block != nullptr) {
      list.first = block->next;
      --list.count;
      return block;
    }
  }
  return ::operator new((number + 1) * step);
}

void envelope_pool::give(void* block, std::size_t size) noexcept {
  const auto number = (size - 1) / step;
  if (number >= sizes || current == nullptr || current->free_[number].count == pooled_max) {
    ::operator delete(block);
    return;
  }
  auto& list = current->free_[number];
  auto* const freed = static_cast<free_block*>(block);
  freed->next = list.first;
  list.first = freed;
  ++list.count;
}

} // namespace rubicon::scheduler
