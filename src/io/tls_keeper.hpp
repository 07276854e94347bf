// The identity that is in force while its files may change.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "io/tls_identity.hpp"

namespace rubicon::io {

/// Takes what the files hold when they have changed, once it is good as a whole: a certificate that
/// is being written, or a key that does not fit yet, leaves the former one in force.
class tls_keeper {
public:
  /// @param files empty: there is no TLS
  /// @param name that others look for in the certificate; empty: none
  /// @throws std::runtime_error if what they hold is unfit
  explicit tls_keeper(tls_files files, std::string name = {});

  [[nodiscard]] const tls_files& files() const { return files_; }

  /// Nothing if there is no TLS.
  [[nodiscard]] const std::optional<tls_identity>& identity() const { return identity_; }

  /// How often it has changed.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  /// Looks at the files. @param again also if they are those that were looked at last
  /// @returns what has come of it, for people; empty: there is nothing new
  [[nodiscard]] std::string look(bool again = false);

private:
  struct stamp {
    std::int64_t written_s = 0;
    std::int64_t written_ns = 0;
    std::uint64_t node = 0;
    std::int64_t size = -1;

    friend bool operator==(const stamp&, const stamp&) = default;
  };
  using stamps = std::array<stamp, 3>;

  [[nodiscard]] static stamp stamp_of(const std::string& path);
  [[nodiscard]] stamps stamps_now() const;

  tls_files files_;
  std::string name_;
  stamps seen_;
  std::optional<tls_identity> identity_;
  std::uint64_t changes_ = 0;
};

} // namespace rubicon::io
