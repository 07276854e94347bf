// The actor system of the control plane, beside that of the ecology. CAF stays behind it.
#pragma once

#include <memory>

#include "control/tls.hpp"

namespace rubicon::control {

class system {
public:
  /// @throws std::runtime_error if a file of `tls` cannot be used
  explicit system(const tls_files& tls);
  ~system();
  system(const system&) = delete;
  system& operator=(const system&) = delete;

  /// What the other files of this room work with.
  struct impl;
  [[nodiscard]] impl& inside() { return *impl_; }

private:
  std::unique_ptr<impl> impl_;
};

} // namespace rubicon::control
