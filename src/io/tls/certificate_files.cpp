#include "io/tls/certificate_files.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/descriptor.hpp"

namespace rubicon::io {

namespace {

constexpr std::size_t file_octets_max = 65536;
constexpr mode_t certificate_mode = 0644;
constexpr mode_t key_mode = 0600;

std::string failed(const std::string& path) {
  return path + ": " + std::generic_category().message(errno);
}

std::string_view octets_of(BIO& x) {
  const char* data = nullptr;
  const auto size = BIO_get_mem_data(&x, &data);
  return {data, size > 0 ? static_cast<std::size_t>(size) : 0};
}

/// Copies a file; `block` holds what may be secret.
std::optional<std::string> copy(int from, BIO& to, std::array<char, 4096>& block,
                                const std::string& path) {
  std::size_t total = 0;
  for (;;) {
    const auto size = ::read(from, block.data(), block.size());
    if (size == 0)
      return std::nullopt;
    if (size == -1 && errno == EINTR)
      continue;
    if (size == -1)
      return failed(path);
    total += static_cast<std::size_t>(size);
    if (total > file_octets_max)
      return path + ": too long for a certificate or key";
    if (BIO_write(&to, block.data(), static_cast<int>(size)) != size)
      return path + ": " + openssl_reason();
  }
}

std::variant<owned<BIO>, std::string> content_of(const std::string& path) {
  // Whatever it is, opening it does not wait for anybody.
  const descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  struct stat about {};
  if (file.get() == -1 || ::fstat(file.get(), &about) != 0)
    return failed(path);
  if (!S_ISREG(about.st_mode))
    return path + ": not a file";
  auto content = memory();
  if (!content)
    return path + ": " + openssl_reason();
  std::array<char, 4096> block{};
  const auto why_not = copy(file.get(), *content, block, path);
  OPENSSL_cleanse(block.data(), block.size());
  if (why_not)
    return *why_not;
  return content;
}

int no_password(char* /*to*/, int /*size*/, int /*is_written*/, void* /*user*/) {
  return -1;
}

template <class T, class Decode>
std::variant<owned<T>, std::string> read_pem(const std::string& path, const char* what,
                                             Decode decode) {
  auto content = content_of(path);
  if (auto* why = std::get_if<std::string>(&content))
    return std::move(*why);
  ERR_clear_error();
  owned<T> found(decode(std::get<owned<BIO>>(content).get(), nullptr, no_password, nullptr));
  if (!found)
    return path + ": not " + what + " in PEM (" + openssl_reason() + ')';
  return found;
}

std::optional<std::string> fill(int file, std::string_view octets, const std::string& path) {
  while (!octets.empty()) {
    const auto size = ::write(file, octets.data(), octets.size());
    if (size == -1 && errno != EINTR)
      return failed(path);
    if (size > 0)
      octets.remove_prefix(static_cast<std::size_t>(size));
  }
  if (::fsync(file) != 0)
    return failed(path);
  return std::nullopt;
}

std::optional<std::string> create_file(const std::string& path, mode_t mode,
                                       std::string_view octets) {
  const descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
  if (file.get() == -1 && errno == EEXIST)
    return path + ": it exists already and is never overwritten; choose another name or folder, or "
                  "move it first";
  if (file.get() == -1)
    return failed(path);
  auto why_not = fill(file.get(), octets, path);
  if (why_not)
    ::unlink(path.c_str());
  return why_not;
}

/// At once.
std::optional<std::string> replace(const std::string& path, mode_t mode, BIO& octets) {
  const auto beside = path + ".new";
  ::unlink(beside.c_str()); // of a command that was ended
  if (auto why_not = create_file(beside, mode, octets_of(octets)))
    return why_not;
  if (::rename(beside.c_str(), path.c_str()) == 0)
    return std::nullopt;
  auto why_not = failed(path);
  ::unlink(beside.c_str());
  return why_not;
}

/// Hexadecimal.
std::string serial_of(const X509& x) {
  const owned<BIGNUM> number(ASN1_INTEGER_to_BN(X509_get0_serialNumber(&x), nullptr));
  char* const text = number ? BN_bn2hex(number.get()) : nullptr;
  std::string serial = text == nullptr ? "unknown" : text;
  OPENSSL_free(text);
  return serial;
}

/// Keeps what stands at `path` under another name, too.
std::optional<std::string> keep(const std::string& path, const std::string& as) {
  return ::link(path.c_str(), as.c_str()) == 0 || errno == EEXIST || errno == ENOENT
             ? std::nullopt
             : std::optional(failed(as));
}

owned<BIO> pem_of(EVP_PKEY& x) {
  auto out = memory();
  const bool is_good =
      out && PEM_write_bio_PrivateKey(out.get(), &x, nullptr, nullptr, 0, nullptr, nullptr) == 1;
  return is_good ? std::move(out) : nullptr;
}

owned<BIO> pem_of(X509& x) {
  auto out = memory();
  return out && PEM_write_bio_X509(out.get(), &x) == 1 ? std::move(out) : nullptr;
}

} // namespace

owned<BIO> memory() {
  return owned<BIO>(BIO_new(BIO_s_mem()));
}

std::string path_in(const std::string& folder, std::string_view name, std::string_view ending) {
  return folder + '/' + std::string(name) + std::string(ending);
}

std::string former_in(const std::string& folder) {
  return folder + "/former";
}

std::variant<file_lock, std::string> lock_of(const std::string& folder) {
  return file_lock::take(folder + "/.lock");
}

std::optional<std::string> replace_with(const std::string& path, BIO& octets) {
  return replace(path, certificate_mode, octets);
}

std::optional<std::string> replace_files(const certificate_pair& x, const X509& old,
                                         const std::string& folder, const std::string& host) {
  constexpr mode_t folder_mode = 0700;
  const auto certificate_path = path_in(folder, host, ".crt");
  const auto key_path = path_in(folder, host, ".key");
  const auto certificate = pem_of(*x.certificate);
  const auto key = x.key ? pem_of(*x.key) : nullptr;
  if (!certificate || (x.key && !key))
    return certificate_path + ": " + openssl_reason();
  if (::mkdir(former_in(folder).c_str(), folder_mode) != 0 && errno != EEXIST)
    return failed(former_in(folder));
  const auto former = path_in(former_in(folder), host + '-' + serial_of(old), "");
  if (auto why_not = keep(certificate_path, former + ".crt"))
    return why_not;
  if (key) {
    if (auto why_not = keep(key_path, former + ".key"))
      return why_not;
    if (auto why_not = replace(key_path, key_mode, *key))
      return why_not;
  }
  return replace(certificate_path, certificate_mode, *certificate);
}

std::string openssl_reason() {
  const auto* const reason = ERR_reason_error_string(ERR_peek_last_error());
  ERR_clear_error();
  return "OpenSSL: " + std::string(reason == nullptr ? "no reason given" : reason);
}

std::variant<owned<X509>, std::string> read_certificate(const std::string& path) {
  return read_pem<X509>(path, "a certificate", PEM_read_bio_X509);
}

std::variant<owned<EVP_PKEY>, std::string> read_key(const std::string& path) {
  return read_pem<EVP_PKEY>(path, "a private key without password", PEM_read_bio_PrivateKey);
}

std::string common_name_of(const X509& x) {
  const auto* const subject = X509_get_subject_name(&x);
  const auto at = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  if (at < 0)
    return {};
  unsigned char* octets = nullptr;
  const auto size =
      ASN1_STRING_to_UTF8(&octets, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at)));
  if (size < 0)
    return {};
  std::string name(reinterpret_cast<const char*>(octets), static_cast<std::size_t>(size));
  OPENSSL_free(octets);
  return name;
}

certificate_use use_of(const X509& x) {
  const auto copy = owned<X509>(X509_dup(&x)); // asking fills in what OpenSSL remembers of it
  const auto ends = copy ? X509_get_extended_key_usage(copy.get()) : 0;
  const bool is_server = (ends & XKU_SSL_SERVER) != 0;
  const bool is_client = (ends & XKU_SSL_CLIENT) != 0;
  if (is_server)
    return is_client ? certificate_use::any : certificate_use::host;
  return is_client ? certificate_use::coordinator : certificate_use::none;
}

std::optional<std::chrono::sys_seconds> time_of(const ASN1_TIME& x) {
  const owned<ASN1_STRING> epoch(ASN1_TIME_set(nullptr, 0));
  int days = 0;
  int seconds = 0;
  if (!epoch || ASN1_TIME_diff(&days, &seconds, epoch.get(), &x) != 1)
    return std::nullopt;
  return std::chrono::sys_seconds(std::chrono::days(days) + std::chrono::seconds(seconds));
}

std::optional<std::string> create_files(const certificate_pair& x,
                                        const std::string& certificate_path,
                                        const std::string& key_path) {
  ERR_clear_error();
  const auto key = pem_of(*x.key);
  if (!key)
    return key_path + ": " + openssl_reason();
  const auto certificate = pem_of(*x.certificate);
  if (!certificate)
    return certificate_path + ": " + openssl_reason();
  if (auto why_not = create_file(key_path, key_mode, octets_of(*key)))
    return why_not;
  auto why_not = create_file(certificate_path, certificate_mode, octets_of(*certificate));
  if (why_not)
    ::unlink(key_path.c_str());
  return why_not;
}

} // namespace rubicon::io
