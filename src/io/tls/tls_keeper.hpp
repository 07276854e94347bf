// The identity that is in force while its files may change.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/tls/revocations.hpp"
#include "io/tls/tls_identity.hpp"

namespace rubicon::io {

/// Takes what the files hold when they have changed, once it is good as a whole: a certificate that
/// is being written, or a key that does not fit yet, leaves the former one in force.
///
/// Of lists of revoked certificates the one with the highest number is in force, wherever it came
/// from: the file beside the authority, somebody who has sent it, or an earlier process.
class tls_keeper {
public:
  /// @param files empty: there is no TLS
  /// @param name that others look for in the certificate; empty: none
  /// @param store how the names of files begin in which lists outlive this process; empty: they do
  ///             not
  /// @throws std::runtime_error if what they hold is unfit
  explicit tls_keeper(tls_files files, std::string name = {}, std::string store = {});

  [[nodiscard]] const tls_files& files() const { return files_; }

  /// Nothing if there is no TLS.
  [[nodiscard]] const std::optional<tls_identity>& identity() const { return identity_; }

  /// Nothing if there has never been one.
  [[nodiscard]] const std::optional<revocation_list>& revoked() const { return revoked_; }

  /// What does not prevent a start and is yet worth a warning.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  /// How often the certificate has changed.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  /// Looks at the files. @param again also if they are those that were looked at last
  /// @returns what has come of it, for people; empty: there is nothing new
  [[nodiscard]] std::string look(bool again = false);

  /// What has come of a list.
  struct outcome {
    bool is_taken = false;
    std::string report; ///< for people; empty: it is the one that is in force
  };

  /// A list that anybody may have sent. It is in force if it is newer, and good.
  [[nodiscard]] outcome take(const std::string& pem);

private:
  struct stamp {
    std::int64_t written_s = 0;
    std::int64_t written_ns = 0;
    std::uint64_t node = 0;
    std::int64_t size = -1;

    friend bool operator==(const stamp&, const stamp&) = default;
  };
  struct stamps {
    std::array<stamp, 3> certificate;
    stamp list;

    friend bool operator==(const stamps&, const stamps&) = default;
  };

  [[nodiscard]] static stamp stamp_of(const std::string& path);
  [[nodiscard]] stamps stamps_now() const;
  [[nodiscard]] std::string list_path() const;
  [[nodiscard]] std::string stored_path(const tls_identity& x) const;
  [[nodiscard]] std::string adopt(tls_identity x);
  [[nodiscard]] outcome take(revocation_list x);
  void begin_with_list();
  [[nodiscard]] std::string look_at_certificate();
  [[nodiscard]] std::string look_at_list();

  tls_files files_;
  std::string name_;
  std::string store_;
  stamps seen_;
  std::optional<tls_identity> identity_;
  std::optional<revocation_list> revoked_;
  std::vector<std::string> warnings_;
  std::uint64_t changes_ = 0;
};

} // namespace rubicon::io
