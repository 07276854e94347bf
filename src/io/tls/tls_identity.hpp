// What one end of a TLS connection shows, and whom it believes: a certificate, its key, and the
// authority that has signed those of the others. Checked as a whole before it is used.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "io/tls/certificates.hpp"
#include "io/tls/revocations.hpp"

namespace rubicon::io {

/// PEM files, as `rubicon certs` makes them. Both ends of a connection show a certificate, and each
/// takes only those of its own authority.
struct tls_files {
  std::string certificate; ///< path; empty: there is no TLS
  std::string key;
  std::string authority;

  [[nodiscard]] bool empty() const { return certificate.empty(); }

  friend bool operator==(const tls_files&, const tls_files&) = default;
};

/// Copies share it; it does not change, whatever becomes of the files.
class tls_identity {
public:
  /// @param name that others look for in the certificate; empty: none
  /// @returns it, or what makes it unfit: a file that is none, a key that others may read or that
  ///          is another's, an authority that has not signed the certificate, dates, another name
  [[nodiscard]] static std::variant<tls_identity, std::string>
  load(const tls_files& files, std::chrono::sys_seconds now, const std::string& name = {});

  /// What others see: `kitchen`
  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] std::chrono::sys_seconds valid_from() const;
  [[nodiscard]] std::chrono::sys_seconds valid_until() const;
  [[nodiscard]] certificate_use use() const;

  /// Hexadecimal digits that distinguish the key of the authority from those of others.
  [[nodiscard]] std::string authority_mark() const;

  /// When the own certificate was taken back; nothing: it was not.
  [[nodiscard]] std::optional<std::chrono::sys_seconds> revoked_by(const revocation_list& x) const;

  /// The same, but it does not believe those that are on the list.
  /// @param revoked of its authority
  [[nodiscard]] std::variant<tls_identity, std::string> with(const revocation_list& revoked) const;

  /// For the other files of this room.
  struct content;
  [[nodiscard]] const std::shared_ptr<const content>& inside() const { return content_; }

private:
  explicit tls_identity(std::shared_ptr<const content> x) : content_(std::move(x)) {}

  std::shared_ptr<const content> content_;
};

/// `2026-11-26 21:05 UTC`
[[nodiscard]] std::string time_text(std::chrono::sys_seconds x);

} // namespace rubicon::io
