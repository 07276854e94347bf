// What this end of the control plane shows others, and whom it believes.
#pragma once

#include <string>

#include "control/tls.hpp"
#include "io/tls/tls_keeper.hpp"

namespace rubicon::control {

class system {
public:
  /// @param host whose name the certificate must have; empty: any
  /// @param store where lists of revoked certificates outlive the process, as tls_keeper has it
  /// @throws std::runtime_error if the files of `tls` cannot be used
  explicit system(const tls_files& tls, const std::string& host = {}, const std::string& store = {})
      : own_(tls, host, store) {}
  system(const system&) = delete;
  system& operator=(const system&) = delete;

  [[nodiscard]] io::tls_keeper& own() { return own_; }

private:
  io::tls_keeper own_;
};

} // namespace rubicon::control
