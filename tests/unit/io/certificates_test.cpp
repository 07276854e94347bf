#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <variant>
#include <vector>

#include <sys/stat.h>

#include "support/catch.hpp"
#include "support/text.hpp"
#include "unit/io/certificates_fixture.hpp"

using namespace rubicon::io;
using namespace rubicon::test;
using std::chrono::days;
using std::chrono::sys_seconds;

namespace {

struct question {
  int purpose = X509_PURPOSE_SSL_SERVER;
  sys_seconds at = today;
  std::string name = {};
  std::string ip = {};
};

/// As a TLS library asks. @returns X509_V_OK or why not
int verdict(X509& authority, X509& x, const question& asked) {
  const owned<X509_STORE> trusted(X509_STORE_new());
  const owned<X509_STORE_CTX> context(X509_STORE_CTX_new());
  REQUIRE(X509_STORE_add_cert(trusted.get(), &authority) == 1);
  REQUIRE(X509_STORE_CTX_init(context.get(), trusted.get(), &x, nullptr) == 1);
  auto* const rules = X509_STORE_CTX_get0_param(context.get());
  X509_VERIFY_PARAM_set_flags(rules, X509_V_FLAG_X509_STRICT);
  X509_VERIFY_PARAM_set_time(rules, asked.at.time_since_epoch().count());
  REQUIRE(X509_VERIFY_PARAM_set_purpose(rules, asked.purpose) == 1);
  if (!asked.name.empty())
    REQUIRE(X509_VERIFY_PARAM_set1_host(rules, asked.name.c_str(), 0) == 1);
  if (!asked.ip.empty())
    REQUIRE(X509_VERIFY_PARAM_set1_ip_asc(rules, asked.ip.c_str()) == 1);
  X509_verify_cert(context.get());
  return X509_STORE_CTX_get_error(context.get());
}

unsigned mode_of(const std::string& path) {
  struct stat x {};
  REQUIRE(::stat(path.c_str(), &x) == 0);
  return x.st_mode & 07777U;
}

std::size_t files_in(const std::string& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// The most permissive there is, as long as this lives.
class open_umask {
public:
  open_umask() : before_(::umask(0)) {}
  ~open_umask() { ::umask(before_); }
  open_umask(const open_umask&) = delete;
  open_umask& operator=(const open_umask&) = delete;

private:
  mode_t before_;
};

} // namespace

TEST_CASE("an authority may sign, for ten years, and nothing but certificates of hosts", "[io]") {
  const scratch_folder scratch;
  const auto made = good(make_authority(scratch.file("certs"), {"flat-12"}, today));
  CHECK(made.file == scratch.file("certs/ca.crt"));
  CHECK(made.key_file == scratch.file("certs/ca.key"));
  CHECK(made.valid_until == today + days(3652));
  const auto x = certificate_of(made.file);
  CHECK(X509_check_ca(x.get()) == 1);
  CHECK(X509_get_pathlen(x.get()) == 0);
  CHECK(X509_get_key_usage(x.get()) == (KU_KEY_CERT_SIGN | KU_CRL_SIGN));
  CHECK(X509_check_private_key(x.get(), key_of(made.key_file).get()) == 1);
  CHECK(X509_self_signed(x.get(), 1) == 1);
  CHECK(verdict(*x, *x, {X509_PURPOSE_ANY}) == X509_V_OK);
}

TEST_CASE("keys are their owner's only, whatever the umask", "[io]") {
  const scratch_folder scratch;
  const open_umask until_end;
  const auto folder = scratch.file("certs");
  const auto authority = good(make_authority(folder, {}, today));
  const auto host = make_host(folder, "kitchen");
  CHECK(mode_of(folder) == 0700U);
  CHECK(mode_of(authority.key_file) == 0600U);
  CHECK(mode_of(host.key_file) == 0600U);
  CHECK(mode_of(host.file) == 0644U);
}

TEST_CASE("the certificate of a host is good for both ends of a connection, for its addresses",
          "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  const auto ca = certificate_of(good(make_authority(folder, {}, today)).file);
  const auto made = make_host(folder, "kitchen_pc-1", {"10.0.0.5", "fe80::1", "kitchen.example"});
  const auto x = certificate_of(made.file);
  CHECK(made.valid_until == today + days(825));

  const auto purpose = GENERATE(X509_PURPOSE_SSL_SERVER, X509_PURPOSE_SSL_CLIENT);
  CHECK(verdict(*ca, *x, {purpose}) == X509_V_OK);
  CHECK(verdict(*ca, *x, {purpose, today, "kitchen_pc-1"}) == X509_V_OK);
  CHECK(verdict(*ca, *x, {purpose, today, "kitchen.example"}) == X509_V_OK);
  CHECK(verdict(*ca, *x, {purpose, today, "", "10.0.0.5"}) == X509_V_OK);
  CHECK(verdict(*ca, *x, {purpose, today, "", "fe80:0::1"}) == X509_V_OK);
  CHECK(verdict(*ca, *x, {purpose, today, "bedroom"}) == X509_V_ERR_HOSTNAME_MISMATCH);
  CHECK(verdict(*ca, *x, {purpose, today, "", "10.0.0.6"}) == X509_V_ERR_IP_ADDRESS_MISMATCH);
  CHECK(verdict(*ca, *x, {purpose, today - std::chrono::hours(23)}) == X509_V_OK);
  CHECK(verdict(*ca, *x, {purpose, today - days(2)}) == X509_V_ERR_CERT_NOT_YET_VALID);
  CHECK(verdict(*ca, *x, {purpose, today + days(826)}) == X509_V_ERR_CERT_HAS_EXPIRED);
}

TEST_CASE("the certificate of a host allows what TLS needs, and no more", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  const auto x = certificate_of(make_host(folder, "kitchen").file);
  CHECK(X509_check_ca(x.get()) == 0);
  CHECK(X509_get_key_usage(x.get()) == KU_DIGITAL_SIGNATURE);
  CHECK(X509_get_extended_key_usage(x.get()) == (XKU_SSL_SERVER | XKU_SSL_CLIENT));
  CHECK(X509_get_version(x.get()) == X509_VERSION_3);
  CHECK(X509_get_signature_nid(x.get()) == NID_ecdsa_with_SHA256);
  std::array<char, 32> group{};
  CHECK(EVP_PKEY_get_group_name(X509_get0_pubkey(x.get()), group.data(), group.size(), nullptr) ==
        1);
  CHECK(std::string(group.data()) == SN_X9_62_prime256v1);
}

TEST_CASE("serial numbers have 128 bits and differ", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  const auto a = certificate_of(make_host(folder, "a").file);
  const auto b = certificate_of(make_host(folder, "b").file);
  CHECK(ASN1_STRING_length(X509_get0_serialNumber(a.get())) == 16);
  CHECK(ASN1_INTEGER_cmp(X509_get0_serialNumber(a.get()), X509_get0_serialNumber(b.get())) != 0);
}

TEST_CASE("no certificate lasts longer than its authority", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  const auto ca = good(make_authority(folder, {"flat", 100}, today));
  CHECK(make_host(folder, "kitchen").valid_until == ca.valid_until);
  CHECK(good(make_certificate(folder, {"attic", {}, 7}, today)).valid_until == today + days(7));
  const auto late = make_certificate(folder, {"bedroom"}, ca.valid_until);
  CHECK(refusal(late).starts_with(ca.file + ": the authority has expired"));
  CHECK(files_in(folder) == 6);
}

TEST_CASE("nothing is overwritten and no half of a pair is left behind", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  const auto make = [&] {
    return std::vector{refusal(make_authority(folder, {}, today)),
                       refusal(make_certificate(folder, {"kitchen"}, today))};
  };
  for (const auto& why : make())
    CHECK(why.empty());
  const auto paths =
      std::vector{scratch.file("certs/ca.crt"), scratch.file("certs/ca.key"),
                  scratch.file("certs/kitchen.crt"), scratch.file("certs/kitchen.key")};
  std::vector<std::string> before;
  for (const auto& path : paths)
    before.push_back(text_of(path));
  for (const auto& why : make())
    CHECK(why.find("exists already and is never overwritten; choose another") != std::string::npos);
  for (std::size_t i = 0; i < paths.size(); ++i)
    CHECK(text_of(paths[i]) == before[i]);

  const auto first = GENERATE(as<std::string>{}, "attic.crt", "attic.key");
  put(scratch.file("certs/" + first), "mine");
  CHECK(refusal(make_certificate(folder, {"attic"}, today)).find("/" + first + ": it exists") !=
        std::string::npos);
  CHECK(text_of(scratch.file("certs/" + first)) == "mine");
  CHECK(files_in(folder) == 5);
}

TEST_CASE("a link in the place of a key is not followed", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  fs::create_symlink(scratch.file("elsewhere"), scratch.file("certs/kitchen.key"));
  CHECK(!refusal(make_certificate(folder, {"kitchen"}, today)).empty());
  CHECK(!fs::exists(scratch.file("elsewhere")));
  CHECK(!fs::exists(scratch.file("certs/kitchen.crt")));
}

TEST_CASE("a name that is none makes no file", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  const auto name = GENERATE(as<std::string>{}, "", ".", "..", "../kitchen", "/tmp/kitchen", "a/b",
                             "a b", "a.b", "kitchen\n", "küche", "a,DNS:b", "ca",
                             "a-name-of-thirty-three-characters", std::string("a\0b", 3));
  CAPTURE(name);
  CHECK(refusal(make_certificate(folder, {name}, today)).starts_with('`' + name + "`: "));
  CHECK(files_in(folder) == 2);
  if (name != "ca") {
    CHECK(refusal(make_authority(scratch.file("other"), {name}, today)).starts_with('`' + name));
    CHECK(!fs::exists(scratch.file("other")));
  }
}

TEST_CASE("an address is an IP address or a DNS name", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  const auto bad =
      GENERATE(as<std::string>{}, "", ".", "a..b", "a.", "-a", "a-", "*.example", "a b", "a,DNS:b",
               "DNS:a", "300.1.1.1", "1.2.3", "12", "::1%eth0", "10.0.0.5:80", "[::1]", "a/b",
               "käse.example", "a\n", std::string("1.2.3.4\0x", 9), std::string("a\0b", 3),
               std::string(64, 'a'), std::string(127, 'a') + '.' + std::string(126, 'b'));
  CAPTURE(bad);
  CHECK(refusal(make_certificate(folder, {"kitchen", {"a.b", bad}}, today)) ==
        '`' + bad + "`: neither an IP address nor a DNS name");
  CHECK(files_in(folder) == 2);
}

TEST_CASE("there may be as many addresses as the limit says, each once", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  std::vector<std::string> all;
  while (all.size() < certificate_addresses_max)
    all.push_back("h" + std::to_string(all.size()) + '.' + std::string(63, 'x') + ".example");
  CHECK(!make_host(folder, "kitchen", all).file.empty());
  CHECK(listed(folder, "kitchen").addresses.size() == certificate_addresses_max + 1);
  CHECK(is_good(listed(folder, "kitchen"), today));
  all.emplace_back("one.more");
  CHECK(refusal(make_certificate(folder, {"attic", all}, today)) == "more than 64 addresses");
  make_host(folder, "bedroom", {"bedroom", "10.0.0.1", "10.0.0.1"});
  CHECK(listed(folder, "bedroom").addresses == std::vector<std::string>{"bedroom", "10.0.0.1"});
}

TEST_CASE("without an authority that can sign there is no certificate, and the file is named",
          "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  const auto other = scratch.file("other");
  const auto ca = good(make_authority(folder, {}, today));
  const auto alien = good(make_authority(other, {}, today));
  const auto host = make_host(other, "kitchen");
  const auto why = [&] { return refusal(make_certificate(folder, {"attic"}, today)); };
  const auto replace = [](const std::string& from, const std::string& to) {
    fs::copy_file(from, to, fs::copy_options::overwrite_existing);
  };
  CHECK(refusal(make_certificate(scratch.file("none"), {"attic"}, today)) ==
        scratch.file("none/ca.crt") + ": No such file or directory");

  replace(alien.key_file, ca.key_file);
  CHECK(why() == ca.key_file + ": not the key of " + ca.file);
  replace(host.file, ca.file);
  replace(host.key_file, ca.key_file);
  CHECK(why() == ca.file + ": the certificate of a host, not of an authority");
  replace(alien.file, ca.file);
  put(ca.key_file, "-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n");
  CHECK(why().starts_with(ca.key_file + ": not a private key without password in PEM (OpenSSL: "));
  fs::remove(ca.key_file);
  CHECK(why() == ca.key_file + ": No such file or directory");
  for (const std::string& garbage :
       {std::string(), std::string(1000, '\0'), std::string("-----BEGIN CERTIFICATE-----\n"),
        text_of(alien.key_file)}) {
    put(ca.file, garbage);
    CHECK(why().starts_with(ca.file + ": not a certificate in PEM (OpenSSL: "));
  }
  put(ca.file, std::string(70000, 'x'));
  CHECK(why() == ca.file + ": too long for a certificate or key");
  fs::remove(ca.file);
  fs::create_directory(ca.file);
  CHECK(why() == ca.file + ": not a file");
  fs::remove(ca.file);
  REQUIRE(::mkfifo(ca.file.c_str(), 0600) == 0); // nobody ever writes into it
  CHECK(why() == ca.file + ": not a file");
  CHECK(!fs::exists(scratch.file("certs/attic.crt")));
  CHECK(!fs::exists(scratch.file("certs/attic.key")));
}

TEST_CASE("nobody is asked for the password of a key", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  const auto ca = good(make_authority(folder, {}, today));
  const auto key = key_of(ca.key_file);
  {
    const opened_file file(std::fopen(ca.key_file.c_str(), "we"), &std::fclose);
    const std::string word = "secret";
    REQUIRE(PEM_write_PrivateKey(file.get(), key.get(), EVP_aes_128_cbc(),
                                 reinterpret_cast<const unsigned char*>(word.data()),
                                 static_cast<int>(word.size()), nullptr, nullptr) == 1);
  }
  CHECK(refusal(make_certificate(folder, {"kitchen"}, today))
            .starts_with(ca.key_file + ": not a private key without password in PEM"));
  CHECK(listed(folder, "rubicon").key == key_state::unreadable);
}

TEST_CASE("a folder that cannot be made or is none is told", "[io]") {
  const scratch_folder scratch;
  CHECK(refusal(make_authority(scratch.file("a/b"), {}, today)) ==
        scratch.file("a/b") + ": No such file or directory");
  put(scratch.file("file"), "");
  CHECK(refusal(make_authority(scratch.file("file"), {}, today)) ==
        scratch.file("file/ca.key") + ": Not a directory");
}
