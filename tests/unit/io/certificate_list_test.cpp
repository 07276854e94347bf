#include <filesystem>
#include <string>
#include <vector>

#include <sys/stat.h>

#include "core/numbers/random.hpp"
#include "support/catch.hpp"
#include "unit/io/certificates_fixture.hpp"

using namespace rubicon;
using namespace rubicon::io;
using namespace rubicon::test;
using std::chrono::days;

TEST_CASE("the list has the authority first, then the hosts by name, with what they say", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {"flat"}, today)));
  make_host(folder, "kitchen", {"10.0.0.5", "fe80::1", "kitchen.example"});
  make_host(folder, "attic");
  put(scratch.file("certs/notes.txt"), "");
  const auto all = good(list_certificates(folder));
  REQUIRE(all.size() == 3);
  CHECK(all[0].file == "ca.crt");
  CHECK(all[0].name == "flat");
  CHECK(all[0].addresses.empty());
  CHECK(all[1].name == "attic");
  CHECK(all[2].name == "kitchen");
  CHECK(all[2].addresses ==
        std::vector<std::string>{"kitchen", "10.0.0.5", "fe80::1", "kitchen.example"});
  CHECK(all[2].valid_from == today - days(1));
  CHECK(all[2].valid_until == today + days(825));
  for (const auto& x : all) {
    CHECK(x.signed_by_authority);
    CHECK(x.key == key_state::safe);
    CHECK(is_good(x, today));
    CHECK(!is_good(x, x.valid_until));
    CHECK(is_good(x, x.valid_until - std::chrono::seconds(1)));
    CHECK(!is_good(x, x.valid_from - std::chrono::seconds(1)));
  }
}

TEST_CASE("the list tells certificates of another authority, though it has the same name", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  static_cast<void>(good(make_authority(scratch.file("other"), {}, today)));
  fs::copy_file(make_host(scratch.file("other"), "kitchen").file,
                scratch.file("certs/kitchen.crt"));
  const auto x = listed(folder, "kitchen");
  CHECK(!x.signed_by_authority);
  CHECK(x.key == key_state::missing);
  CHECK(!is_good(x, today));
}

TEST_CASE("the list tells what is wrong with a key", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  const auto kitchen = make_host(folder, "kitchen");
  const auto attic = make_host(folder, "attic");
  const auto state = [&] { return listed(folder, "kitchen").key; };
  const auto mode = GENERATE(0640U, 0604U, 0620U, 0601U);
  REQUIRE(::chmod(kitchen.key_file.c_str(), mode) == 0);
  CHECK(state() == key_state::exposed);
  CHECK(!is_good(listed(folder, "kitchen"), today));
  CHECK(is_good(listed(folder, "attic"), today));
  fs::rename(attic.key_file, kitchen.key_file);
  CHECK(state() == key_state::foreign);
  CHECK(!is_good(listed(folder, "kitchen"), today));
  CHECK(listed(folder, "attic").key == key_state::missing);
  CHECK(is_good(listed(folder, "attic"), today)); // it is where it is needed
  put(kitchen.key_file, "no key");
  CHECK(state() == key_state::unreadable);
}

TEST_CASE("a file that is no certificate has its row and its reason", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  const auto name = GENERATE(as<std::string>{}, "empty", "\x1b[2J\n", "\xff\xfe", "..", "-");
  CAPTURE(name);
  put(scratch.file("certs/" + name + ".crt"), "");
  put(scratch.file("certs/.crt"), "");
  CHECK(good(list_certificates(folder)).size() == 2);
  const auto x = listed(folder, name);
  CHECK(x.file == name + ".crt");
  CHECK(x.problem.starts_with(scratch.file("certs/" + name + ".crt") + ": not a certificate"));
  CHECK(!is_good(x, today));
}

TEST_CASE("there is no list without an authority", "[io]") {
  const scratch_folder scratch;
  CHECK(refusal(list_certificates(scratch.file("none"))) ==
        scratch.file("none/ca.crt") + ": No such file or directory");
  put(scratch.file("ca.crt"), "garbage");
  CHECK(refusal(list_certificates(scratch.file(".")))
            .starts_with(scratch.file("./ca.crt: not a certificate in PEM")));
}

TEST_CASE("a certificate that was tampered with is never good, and never a crash", "[io]") {
  const scratch_folder scratch;
  const auto folder = scratch.file("certs");
  static_cast<void>(good(make_authority(folder, {}, today)));
  const auto path = make_host(folder, "kitchen", {"10.0.0.5", "kitchen.example"}).file;
  unsigned char* der = nullptr;
  const auto size = i2d_X509(certificate_of(path).get(), &der);
  REQUIRE(size > 0);
  const std::vector<unsigned char> octets(der, der + size);
  OPENSSL_free(der);
  random_stream random(7);
  for (int round = 0; round < 500; ++round) {
    auto changed = octets;
    for (auto left = 1 + random.below(3); left > 0; --left)
      changed[random.below(changed.size())] ^= static_cast<unsigned char>(1 + random.below(255));
    if (changed == octets)
      continue;
    const opened_file file(std::fopen(path.c_str(), "we"), &std::fclose);
    REQUIRE(PEM_write(file.get(), "CERTIFICATE", "", changed.data(),
                      static_cast<long>(changed.size())) > 0);
    REQUIRE(std::fflush(file.get()) == 0);
    const auto all = good(list_certificates(folder));
    REQUIRE(all.size() == 2);
    CAPTURE(round, all[1].name);
    CHECK(is_good(all[0], today));
    CHECK(!is_good(all[1], today));
  }
}
