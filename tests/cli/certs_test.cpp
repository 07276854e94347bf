// `rubicon certs` as a user meets it.
#include <filesystem>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"

using rubicon::test::outcome;
using rubicon::test::scratch_folder;
using rubicon::test::shell;

namespace {

namespace fs = std::filesystem;

const std::string binary = RUBICON_BINARY;

/// A folder of its own in which commands run, gone with the test.
class work_folder {
public:
  [[nodiscard]] outcome run(const std::string& arguments) const {
    return in('"' + binary + "\" certs " + arguments + " 2>/dev/null");
  }
  [[nodiscard]] outcome complaint_of(const std::string& arguments) const {
    return in('"' + binary + "\" certs " + arguments + " 2>&1 >/dev/null");
  }
  [[nodiscard]] outcome in(const std::string& command) const {
    return shell("cd '" + folder_.path.string() + "' && " + command);
  }
  [[nodiscard]] fs::path file(const std::string& name) const { return folder_.path / name; }

private:
  const scratch_folder folder_;
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

bool has_openssl() {
  return shell("openssl version 2>&1").status == 0;
}

} // namespace

TEST_CASE("an authority and certificates are made, and listed", "[cli]") {
  const work_folder at;
  const auto made = at.run("init --name flat");
  CHECK(made.status == 0);
  CHECK(made.out.starts_with("certs/ca.crt, valid until 20"));
  const auto host = at.run("add --address 10.0.0.5 kitchen --host --address kitchen.example");
  CHECK(host.status == 0);
  CHECK(host.out.starts_with("certs/kitchen.crt, valid until 20"));
  CHECK(contains(host.out, "\ncerts/kitchen.key, its key: for kitchen only"));
  CHECK(contains(made.out, "\nNext: rubicon certs add HOST --host"));
  CHECK(contains(host.out, "\nNext: copy these two and certs/ca.crt to kitchen; there: rubicon "
                           "host --name kitchen --listen ADDRESS:4242 --tls-cert kitchen.crt"));
  CHECK(!contains(made.out + host.out, "BEGIN"));

  const auto table = at.run("list");
  CHECK(table.status == 0);
  CHECK(contains(table.out, "kitchen  kitchen 10.0.0.5 kitchen.example  20"));
  CHECK(at.complaint_of("list").out.empty());

  const auto json = nlohmann::json::parse(at.run("list --json").out);
  REQUIRE(json.size() == 2);
  CHECK(json[0].at("name") == "flat");
  CHECK(json[1].at("file") == "kitchen.crt");
  CHECK(json[1].at("addresses") ==
        std::vector<std::string>{"kitchen", "10.0.0.5", "kitchen.example"});
  CHECK(json[1].at("days_left").get<int>() >= 824);
  CHECK(json[1].at("signed_by_ca") == true);
  CHECK(json[1].at("key") == "safe");
  CHECK(json[1].at("good") == true);
}

TEST_CASE("openssl verifies what was made, and takes its key", "[cli]") {
  if (!has_openssl()) {
    WARN("openssl is not installed");
    return;
  }
  const work_folder at;
  REQUIRE(at.run("init --dir x").status == 0);
  REQUIRE(at.run("add kitchen --host --dir x --address 10.0.0.5 --days 30").status == 0);
  REQUIRE(at.run("add me --coordinator --dir x").status == 0);
  const auto verified = [&](const std::string& with, const std::string& file) {
    const auto x =
        at.in("openssl verify -x509_strict " + with + " -CAfile x/ca.crt x/" + file + ".crt 2>&1");
    return x.status == 0 && x.out == "x/" + file + ".crt: OK\n";
  };
  CHECK(verified("-verify_ip 10.0.0.5 -purpose sslserver", "kitchen"));
  CHECK_FALSE(verified("-purpose sslclient", "kitchen"));
  CHECK(verified("-purpose sslclient", "me"));
  CHECK_FALSE(verified("-purpose sslserver", "me"));
  REQUIRE(at.run("renew kitchen --dir x").status == 0);
  CHECK(verified("-verify_ip 10.0.0.5 -purpose sslserver", "kitchen"));
  REQUIRE(at.run("revoke me --dir x").status == 0);
  CHECK(verified("-crl_check -CRLfile x/ca.crl", "kitchen"));
  CHECK_FALSE(verified("-crl_check -CRLfile x/ca.crl", "me"));
  CHECK(contains(at.in("openssl crl -in x/ca.crl -noout -crlnumber").out, "=0x01"));
  CHECK(at.in("openssl pkey -in x/kitchen.key -noout -check 2>&1").status == 0);
  REQUIRE(at.run("init --dir y").status == 0);
  CHECK(at.in("openssl verify -CAfile y/ca.crt x/kitchen.crt 2>&1").status != 0);
}

TEST_CASE("what is no good is told by the exit status", "[cli]") {
  const work_folder at;
  REQUIRE(at.run("init").status == 0);
  REQUIRE(at.run("add kitchen --host").status == 0);
  SECTION("a key that others can read") {
    fs::permissions(at.file("certs/kitchen.key"), fs::perms::others_read, fs::perm_options::add);
    CHECK(contains(at.run("list").out, "exposed"));
  }
  SECTION("a certificate of another authority") {
    REQUIRE(at.run("init --dir other").status == 0);
    REQUIRE(at.run("add attic --host --dir other").status == 0);
    fs::copy_file(at.file("other/attic.crt"), at.file("certs/attic.crt"));
    CHECK(nlohmann::json::parse(at.run("list --json").out)[1].at("signed_by_ca") == false);
  }
  SECTION("garbage, whatever its name") {
    std::ofstream(at.file("certs/\x1b[2J\xff.crt")) << "garbage";
    const auto x = at.complaint_of("list");
    CHECK(x.out.starts_with("certs/\\x1b[2J\\xff.crt: not a certificate in PEM"));
    CHECK(!contains(at.run("list").out, "\x1b"));
    CHECK(nlohmann::json::parse(at.run("list --json").out)[1].at("good") == false);
  }
  CHECK(at.run("list").status == 1);
  CHECK(at.run("list --json").status == 1);
}

TEST_CASE("what cannot be done costs one line, status 2 and no file", "[cli]") {
  const work_folder at;
  const auto missing = at.complaint_of("add kitchen --host");
  CHECK(missing.status == 2);
  CHECK(missing.out == "rubicon: certs/ca.crt: No such file or directory; rubicon certs init "
                       "creates an authority\n");
  CHECK(at.complaint_of("list").out == missing.out);
  CHECK(!fs::exists(at.file("certs")));

  REQUIRE(at.run("init").status == 0);
  const auto twice = at.complaint_of("init");
  CHECK(twice.status == 2);
  CHECK(twice.out.starts_with("rubicon: certs/ca.key: it exists already"));
  const auto hostile = at.complaint_of("add ../kitchen --host");
  CHECK(hostile.status == 2);
  CHECK(hostile.out ==
        "rubicon: `../kitchen`: the name of a host is 1 to 32 letters, digits, - and _\n");
  CHECK(
      at.complaint_of("add --host \"$(printf 'a\\033')\"").out.starts_with("rubicon: `a\\x1b`: "));
  CHECK(at.run("add kitchen --host --address 1.2.3").status == 2);
  CHECK(at.run("add kitchen --host >/dev/full").status ==
        2); // the files are there, unlike their names
  CHECK(at.run("list >/dev/full").status == 2);
  CHECK(!fs::exists(at.file("kitchen.crt")));
}

TEST_CASE("a certificate has one use, and one for both can be given one", "[cli]") {
  const work_folder at;
  REQUIRE(at.run("init").status == 0);
  const auto neither = at.complaint_of("add kitchen");
  CHECK(neither.status == 2);
  CHECK(contains(neither.out, "--host"));
  CHECK(contains(neither.out, "--coordinator"));
  CHECK(!fs::exists(at.file("certs/kitchen.crt")));
  CHECK(at.run("add kitchen --host --coordinator").status == 2);
  CHECK(!fs::exists(at.file("certs/kitchen.crt")));
}

TEST_CASE("certificates are renewed and revoked, and listed so", "[cli]") {
  const work_folder at;
  CHECK(contains(at.complaint_of("revoke kitchen").out, "rubicon certs init"));
  REQUIRE(at.run("init").status == 0);
  REQUIRE(at.run("add kitchen --host").status == 0);
  REQUIRE(at.run("add me --coordinator").status == 0);
  const auto renewed = at.run("renew kitchen --days 30");
  CHECK(renewed.status == 0);
  CHECK(renewed.out.starts_with("certs/kitchen.crt, valid until 20"));
  CHECK(contains(renewed.out, "its key is unchanged"));
  CHECK(contains(at.run("renew kitchen --new-key").out, "certs/kitchen.key, its key"));
  CHECK(contains(at.complaint_of("renew kitchen --coordinator").out, "its use is host"));
  CHECK(at.run("list").status == 0);

  const auto revoked = at.run("revoke me");
  CHECK(revoked.status == 0);
  CHECK(revoked.out.starts_with("certs/ca.crl, number 1: 1 certificate of me more"));
  CHECK(contains(at.run("revoke kitchen").out, "number 2: 3 certificates of kitchen more"));
  const auto twice = at.complaint_of("revoke me");
  CHECK(twice.status == 2);
  CHECK(contains(twice.out, "already revoked"));
  CHECK(at.run("list").status == 1);
  CHECK(contains(at.run("list").out, "revoked"));
  const auto json = nlohmann::json::parse(at.run("list --json").out);
  CHECK(json[1].at("revoked") == true);
  CHECK(json[0].at("revoked") == false);
  CHECK(contains(at.complaint_of("renew me").out, "--new-key"));
  CHECK(at.run("renew me --new-key").status == 0);
  CHECK(at.run("renew kitchen --new-key").status == 0);
  CHECK(at.run("list").status == 0);
  std::ofstream(at.file("certs/ca.crl")) << "garbage";
  CHECK(at.run("list").status == 1);
  CHECK(contains(at.complaint_of("list").out, "certs/ca.crl: is not a list"));
  CHECK(at.run("revoke me").status == 2);
}
