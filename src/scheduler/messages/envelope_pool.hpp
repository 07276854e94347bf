// Memory of envelopes, which are made and ended millions of times a second.
#pragma once

#include <array>
#include <cstddef>

namespace rubicon::scheduler {

/// Keeps blocks that were given back for the next envelope of like size: one pool for each logical
/// process, used by the thread that executes it. A block may be given back to another pool than it
/// was taken from.
class envelope_pool {
public:
  envelope_pool() = default;
  ~envelope_pool();
  envelope_pool(const envelope_pool&) = delete;
  envelope_pool& operator=(const envelope_pool&) = delete;

  /// Of the process that this thread executes; nullptr: memory comes from the system.
  static inline constinit thread_local envelope_pool* current = nullptr; // NOLINT

  [[nodiscard]] static void* take(std::size_t size);
  static void give(void* block, std::size_t size) noexcept;

private:
  static constexpr std::size_t step = 32;        ///< between sizes, in octets
  static constexpr std::size_t sizes = 8;        ///< larger blocks are the system's
  static constexpr std::size_t pooled_max = 256; ///< of each size

  struct free_block {
    free_block* next;
  };
  struct free_list {
    free_block* first = nullptr;
    std::size_t count = 0;
  };

  std::array<free_list, sizes> free_{};
};

} // namespace rubicon::scheduler
