#include "io/certificate_files.hpp"

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

namespace rubicon::io {

namespace {

constexpr std::size_t file_octets_max = 65536;
constexpr mode_t certificate_mode = 0644;
constexpr mode_t key_mode = 0600;

std::string failed(const std::string& path) {
  return path + ": " + std::generic_category().message(errno);
}

struct descriptor {
  explicit descriptor(int x) : number(x) {}
  ~descriptor() {
    if (number != -1)
      ::close(number);
  }
  descriptor(const descriptor&) = delete;
  descriptor& operator=(const descriptor&) = delete;

  int number;
};

/// A place in memory that OpenSSL wipes when it is given back.
owned<BIO> memory() {
  return owned<BIO>(BIO_new(BIO_s_mem()));
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
  if (file.number == -1 || ::fstat(file.number, &about) != 0)
    return failed(path);
  if (!S_ISREG(about.st_mode))
    return path + ": not a file";
  auto content = memory();
  if (!content)
    return path + ": " + openssl_reason();
  std::array<char, 4096> block{};
  const auto why_not = copy(file.number, *content, block, path);
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
  if (file.number == -1 && errno == EEXIST)
    return path + ": it is there already and never overwritten; choose another name or folder, "
                  "or move it away first";
  if (file.number == -1)
    return failed(path);
  auto why_not = fill(file.number, octets, path);
  if (why_not)
    ::unlink(path.c_str());
  return why_not;
}

} // namespace

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
  const auto key = memory();
  if (!key ||
      PEM_write_bio_PrivateKey(key.get(), x.key.get(), nullptr, nullptr, 0, nullptr, nullptr) != 1)
    return key_path + ": " + openssl_reason();
  const auto certificate = memory();
  if (!certificate || PEM_write_bio_X509(certificate.get(), x.certificate.get()) != 1)
    return certificate_path + ": " + openssl_reason();
  if (auto why_not = create_file(key_path, key_mode, octets_of(*key)))
    return why_not;
  auto why_not = create_file(certificate_path, certificate_mode, octets_of(*certificate));
  if (why_not)
    ::unlink(key_path.c_str());
  return why_not;
}

} // namespace rubicon::io
