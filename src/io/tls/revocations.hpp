// The certificates that an authority has taken back before their time: a signed list with a number,
// as RFC 5280 has it (CRL).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace rubicon::io {

/// A longer one, in PEM, is refused.
inline constexpr std::size_t revocations_octets_max = std::size_t{96} << 10;

/// The file in which a list stands beside the authority: `certs/ca.crl` for `certs/ca.crt`.
[[nodiscard]] std::string revocations_beside(const std::string& authority_path);

/// Copies share it.
class revocation_list {
public:
  /// @param pem what anybody may have sent
  /// @param authority_path the certificate by whose key it must be signed
  /// @param may_be_over also one whose time is over
  /// @returns it, or why it is none, as `is signed by another authority`
  [[nodiscard]] static std::variant<revocation_list, std::string>
  read(std::string_view pem, const std::string& authority_path, std::chrono::sys_seconds now,
       bool may_be_over = false);

  /// Counts the lists of the authority: what has a higher one is newer.
  [[nodiscard]] std::uint64_t number() const;
  [[nodiscard]] std::chrono::sys_seconds valid_until() const;
  /// Of certificates.
  [[nodiscard]] std::size_t size() const;
  /// In PEM.
  [[nodiscard]] const std::string& text() const;

  /// For the other files of this room.
  struct content;
  [[nodiscard]] const std::shared_ptr<const content>& inside() const { return content_; }

private:
  explicit revocation_list(std::shared_ptr<const content> x) : content_(std::move(x)) {}

  std::shared_ptr<const content> content_;
};

} // namespace rubicon::io
