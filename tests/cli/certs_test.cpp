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
  const auto host = at.run("add --address 10.0.0.5 kitchen --address kitchen.example");
  CHECK(host.status == 0);
  CHECK(host.out.starts_with("certs/kitchen.crt, valid until 20"));
  CHECK(contains(host.out, "\ncerts/kitchen.key, its key: for kitchen only"));
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
  REQUIRE(at.run("add kitchen --dir x --address 10.0.0.5 --days 30").status == 0);
  for (const auto* as : {"sslserver", "sslclient"}) {
    const auto x = at.in("openssl verify -x509_strict -verify_ip 10.0.0.5 -purpose " +
                         std::string(as) + " -CAfile x/ca.crt x/kitchen.crt 2>&1");
    CHECK(x.status == 0);
    CHECK(x.out == "x/kitchen.crt: OK\n");
  }
  CHECK(at.in("openssl pkey -in x/kitchen.key -noout -check 2>&1").status == 0);
  REQUIRE(at.run("init --dir y").status == 0);
  CHECK(at.in("openssl verify -CAfile y/ca.crt x/kitchen.crt 2>&1").status != 0);
}

TEST_CASE("what is no good is told by the exit status", "[cli]") {
  const work_folder at;
  REQUIRE(at.run("init").status == 0);
  REQUIRE(at.run("add kitchen").status == 0);
  SECTION("a key that others can read") {
    fs::permissions(at.file("certs/kitchen.key"), fs::perms::others_read, fs::perm_options::add);
    CHECK(contains(at.run("list").out, "exposed"));
  }
  SECTION("a certificate of another authority") {
    REQUIRE(at.run("init --dir other").status == 0);
    REQUIRE(at.run("add attic --dir other").status == 0);
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
  const auto missing = at.complaint_of("add kitchen");
  CHECK(missing.status == 2);
  CHECK(missing.out == "rubicon: certs/ca.crt: No such file or directory; "
                       "rubicon certs init makes an authority\n");
  CHECK(at.complaint_of("list").out == missing.out);
  CHECK(!fs::exists(at.file("certs")));

  REQUIRE(at.run("init").status == 0);
  const auto twice = at.complaint_of("init");
  CHECK(twice.status == 2);
  CHECK(twice.out.starts_with("rubicon: certs/ca.key: it is there already"));
  const auto hostile = at.complaint_of("add ../kitchen");
  CHECK(hostile.status == 2);
  CHECK(hostile.out ==
        "rubicon: `../kitchen`: the name of a host is 1 to 32 letters, digits, - and _\n");
  CHECK(at.complaint_of("add \"$(printf 'a\\033')\"").out.starts_with("rubicon: `a\\x1b`: "));
  CHECK(at.run("add kitchen --address 1.2.3").status == 2);
  CHECK(at.run("add kitchen >/dev/full").status == 2); // the files are there, unlike their names
  CHECK(at.run("list >/dev/full").status == 2);
  CHECK(!fs::exists(at.file("kitchen.crt")));
}
