// The memory of one Lua state, with a limit.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <limits>

namespace rubicon::script {

class heap {
public:
  [[nodiscard]] std::size_t used() const { return used_; }

  /// What is used now, and so much more, is the most.
  void limit(std::size_t more) { most_ = used_ + more; }

  /// As lua_Alloc. nullptr: there is no room; what was there remains.
  void* resize(void* old, std::size_t old_size, std::size_t size) {
    if (old == nullptr)
      old_size = 0; // Lua passes a kind of object
    if (size == 0) {
      std::free(old);
      used_ -= old_size;
      return nullptr;
    }
    if (size > old_size && (used_ > most_ || size - old_size > most_ - used_))
      return nullptr;
    void* found = std::realloc(old, size);
    if (found != nullptr)
      used_ = used_ - old_size + size;
    return found;
  }

private:
  std::size_t used_ = 0;
  std::size_t most_ = std::numeric_limits<std::size_t>::max();
};

} // namespace rubicon::script
