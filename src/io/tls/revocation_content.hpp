// For files of this room only: a revocation_list as OpenSSL has it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "io/tls/certificate_files.hpp"
#include "io/tls/revocations.hpp"

namespace rubicon::io {

struct revocation_list::content {
  owned<X509_CRL> list;
  std::string text;
  std::uint64_t number = 0;
  std::size_t size = 0;
  std::chrono::sys_seconds until;
};

[[nodiscard]] bool is_same(const revocation_list& a, const revocation_list& b);

/// When a certificate was taken back; nothing: it was not.
[[nodiscard]] std::optional<std::chrono::sys_seconds> revoked_at(const revocation_list& x,
                                                                 const X509& certificate);

/// The list of an authority's folder. @returns nothing if there is no file
[[nodiscard]] std::variant<std::optional<revocation_list>, std::string>
read_revocations(const std::string& path, const std::string& authority_path,
                 std::chrono::sys_seconds now, bool may_be_over = false);

} // namespace rubicon::io
