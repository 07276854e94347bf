// A file descriptor that is closed with its owner.
#pragma once

#include <utility>

#include <unistd.h>

namespace rubicon::io {

class descriptor {
public:
  descriptor() = default;
  explicit descriptor(int number) : number_(number) {} ///< -1: none
  ~descriptor() { close(); }
  descriptor(descriptor&& x) noexcept : number_(x.take()) {}
  descriptor& operator=(descriptor&&) = delete;

  [[nodiscard]] int get() const { return number_; }
  [[nodiscard]] int take() { return std::exchange(number_, -1); } ///< whose owner the caller is now
  void close() {
    if (number_ != -1)
      ::close(take());
  }

private:
  int number_ = -1;
};

} // namespace rubicon::io
