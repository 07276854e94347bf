// Certificates by which the hosts of a deployment know each other: one authority of their own, and
// a certificate with a key for each host. All are PEM files of one folder: NAME.crt and NAME.key.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rubicon::io {

/// What the authority's files are called; no host may have this name.
inline constexpr std::string_view authority_name = "ca";

inline constexpr unsigned certificate_days_max = 36500;
inline constexpr std::size_t certificate_addresses_max = 64;
/// Certificates and lists are valid from so long before they are made: clocks differ.
inline constexpr std::chrono::days clock_error_max{1};

/// The time of the system's clock.
[[nodiscard]] std::chrono::sys_seconds system_time();

struct new_authority {
  std::string name = "rubicon"; ///< of the deployment; as is_name says
  unsigned days = 3652;         ///< 1 to certificate_days_max
};

/// What a certificate is good for.
enum class certificate_use : std::uint8_t {
  any,         ///< a host's, and whoever has it may deploy to others
  host,        ///< answers who deploys, and may not deploy itself: TLS server
  coordinator, ///< deploys to hosts, and is none: TLS client
  none,        ///< neither
};

[[nodiscard]] std::string_view to_string(certificate_use x);

struct new_certificate {
  std::string host;                           ///< as `name` of `[[host]]`
  std::vector<std::string> addresses = {};    ///< by which others reach it: IP, DNS
  unsigned days = 825;                        ///< 1 to certificate_days_max
  certificate_use use = certificate_use::any; ///< one for both roles is for tests of old ones
};

struct made_certificate {
  std::string file;
  std::string key_file;
  std::chrono::sys_seconds valid_until; ///< of a host's: not later than its authority's
};

/// Makes ca.crt and ca.key, and the folder, for its owner only, if it is not there.
/// @param now what validity counts from: it begins a day before, for hosts whose clocks are wrong
/// @returns what was made, or why nothing was: a name that is none, a file that is there already
[[nodiscard]] std::variant<made_certificate, std::string>
make_authority(const std::string& folder, const new_authority& x, std::chrono::sys_seconds now);

/// Makes HOST.crt and HOST.key, signed with ca.key, valid for the host's name and addresses.
/// @returns what was made, or why nothing was: also an authority that has expired, or is none
[[nodiscard]] std::variant<made_certificate, std::string>
make_certificate(const std::string& folder, const new_certificate& x, std::chrono::sys_seconds now);

struct renewal {
  std::string host;
  unsigned days = 825;
  bool new_key = false;                       ///< else HOST.key, wherever it is, stays as it is
  certificate_use use = certificate_use::any; ///< of a certificate that is for both; else its own
};

/// Makes another HOST.crt for the same name, addresses and use, and a HOST.key if it is asked for.
/// The former ones go to the folder `former`.
/// @returns what was made, or why nothing was: also a certificate that was revoked, if its key is
///          to stay, and one for both roles that is to be for none of them
[[nodiscard]] std::variant<made_certificate, std::string>
renew_certificate(const std::string& folder, const renewal& x, std::chrono::sys_seconds now);

struct made_revocation {
  std::string file;
  std::uint64_t number = 0;
  std::size_t added = 0; ///< certificates: HOST.crt and its former ones
};

/// Writes ca.crl anew, with all that it has listed and those of HOST. It is signed with ca.key, has
/// a number above the last one's and holds as long as the authority.
/// @returns what was done, or why nothing was: all of them are listed already
[[nodiscard]] std::variant<made_revocation, std::string>
revoke_certificate(const std::string& folder, const std::string& host,
                   std::chrono::sys_seconds now);

/// What has become of the private key beside a certificate.
enum class key_state : std::uint8_t {
  safe,       ///< fits, and is its owner's only
  missing,    ///< no harm where it is only needed elsewhere
  exposed,    ///< others may read or change it
  unreadable, ///< by us, or it is no key
  foreign,    ///< of another certificate
};

[[nodiscard]] std::string_view to_string(key_state x);

struct listed_certificate {
  std::string file;    ///< in the folder, such as `kitchen.crt`
  std::string name;    ///< common name; of a file that cannot be read its own, without `.crt`
  std::string problem; ///< why it cannot be read; empty: it can. If not, only `key` follows
  std::vector<std::string> addresses;
  std::chrono::sys_seconds valid_from;
  std::chrono::sys_seconds valid_until;
  bool signed_by_authority = false;
  certificate_use use = certificate_use::any;
  std::optional<std::chrono::sys_seconds> revoked; ///< when; nothing: it was not
  key_state key = key_state::missing;
};

/// Whether a host can show it to others at this time, judged by its file and its key.
[[nodiscard]] bool is_good(const listed_certificate& x, std::chrono::sys_seconds now);

/// All files *.crt of the folder, the authority's first, then in the order of their names, and a
/// list of revoked certificates if that cannot be read; or why nothing can be said, if there is no
/// authority. Names may be anything: see printable().
[[nodiscard]] std::variant<std::vector<listed_certificate>, std::string>
list_certificates(const std::string& folder);

} // namespace rubicon::io
