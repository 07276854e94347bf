// Certificates that are renewed and taken back, and who believes them after that.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "io/tls/certificates.hpp"
#include "io/tls/revocations.hpp"
#include "io/tls/tls_keeper.hpp"
#include "io/tls/tls_session.hpp"
#include "unit/io/certificates_fixture.hpp"
#include "unit/io/tls_fixture.hpp"

using namespace rubicon;
using namespace rubicon::test;
using io::certificate_use;
using io::tls_files;
using io::tls_session;
using std::chrono::days;
using phase = io::tls_session::phase;
using side = io::tls_session::side;

namespace {

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A folder of certificates as `rubicon certs` makes it.
class deployment {
public:
  explicit deployment(std::chrono::sys_seconds now = io::system_time(), unsigned length = 3652) {
    good(io::make_authority(path(), {"flat", length}, now));
  }

  tls_files add(const std::string& name, certificate_use use = certificate_use::host) const {
    good(io::make_certificate(path(), {name, {"10.0.0.5", "a.example"}, 100, use}, now_));
    return files(name);
  }
  [[nodiscard]] tls_files files(const std::string& name) const {
    return {path() + '/' + name + ".crt", path() + '/' + name + ".key", path() + "/ca.crt"};
  }
  std::uint64_t revoke(const std::string& name, std::chrono::sys_seconds now) const {
    return good(io::revoke_certificate(path(), name, now)).number;
  }
  std::uint64_t revoke(const std::string& name) const { return revoke(name, now_); }
  [[nodiscard]] std::string list() const { return text_of(path() + "/ca.crl"); }
  void remove_list() const { fs::remove(path() + "/ca.crl"); }
  [[nodiscard]] std::string path() const { return (folder_.path / "certs").string(); }
  [[nodiscard]] std::string state() const { return (folder_.path / "kitchen").string(); }

private:
  const scratch_folder folder_;
  const std::chrono::sys_seconds now_ = io::system_time();
};

/// Why nothing begins with these files; empty: it does.
std::string why_unfit(const tls_files& x, const std::string& name, const std::string& kept = {}) {
  try {
    const io::tls_keeper keeper(x, name, kept);
    return {};
  } catch (const std::runtime_error& why) {
    return why.what();
  }
}

tls_outcome meet(const io::tls_keeper& host, const io::tls_keeper& coordinator) {
  return test::meet(*host.identity(), *coordinator.identity());
}

} // namespace

TEST_CASE("a renewed certificate is for the same key, names and use, and the former is kept",
          "[io][tls]") {
  const deployment at;
  const auto files = at.add("kitchen");
  const auto before = certificate_of(files.certificate);
  const auto key = text_of(files.key);
  const auto made = good(io::renew_certificate(at.path(), {"kitchen", 300}, io::system_time()));
  CHECK(made.file == files.certificate);
  CHECK(made.key_file.empty());
  const auto after = certificate_of(files.certificate);
  CHECK(text_of(files.key) == key);
  CHECK(ASN1_INTEGER_cmp(X509_get0_serialNumber(before.get()),
                         X509_get0_serialNumber(after.get())) != 0);
  const auto all = good(io::list_certificates(at.path()));
  REQUIRE(all.size() == 2);
  CHECK(all[1].addresses == std::vector<std::string>{"kitchen", "10.0.0.5", "a.example"});
  CHECK(all[1].use == certificate_use::host);
  CHECK(all[1].key == io::key_state::safe);
  CHECK(io::is_good(all[1], io::system_time()));
  CHECK(all[1].valid_until > io::system_time() + days(250));
  CHECK(std::distance(fs::directory_iterator(at.path() + "/former"), {}) == 1);
  CHECK((fs::status(files.certificate).permissions() & fs::perms::others_read) != fs::perms::none);

  good(io::renew_certificate(at.path(), {"kitchen", 300, /*new_key=*/true}, io::system_time()));
  CHECK(text_of(files.key) != key);
  CHECK((fs::status(files.key).permissions() & fs::perms(0077)) == fs::perms::none);
  CHECK(good(io::list_certificates(at.path()))[1].key == io::key_state::safe);
}

TEST_CASE("a key that is elsewhere stays where it is", "[io][tls]") {
  const deployment at;
  const auto files = at.add("kitchen");
  const auto key = text_of(files.key);
  fs::remove(files.key);
  good(io::renew_certificate(at.path(), {"kitchen"}, io::system_time()));
  CHECK_FALSE(fs::exists(files.key));
  put(files.key, key);
  fs::permissions(files.key, fs::perms::owner_read);
  CHECK(why_unfit(files, "kitchen").empty());
}

TEST_CASE("what cannot be renewed stays as it is", "[io][tls]") {
  const deployment at;
  const deployment others;
  const auto now = io::system_time();
  const auto why = [&](const io::renewal& x) {
    return refusal(io::renew_certificate(at.path(), x, now));
  };
  CHECK(has(why({"attic"}), "No such file"));
  CHECK(has(why({"ca"}), "the files of the authority"));
  CHECK(has(why({"../x"}), "1 to 32 letters"));
  at.add("kitchen");
  CHECK(has(why({"kitchen", 100, false, certificate_use::coordinator}), "its use is host"));
  at.add("old", certificate_use::any);
  CHECK(has(why({"old"}), "choose --host or --coordinator"));
  CHECK(why({"old", 100, false, certificate_use::coordinator}).empty());
  CHECK(good(io::list_certificates(at.path()))[2].use == certificate_use::coordinator);
  fs::copy_file(others.add("attic").certificate, at.files("attic").certificate);
  CHECK(has(why({"attic"}), "signed by another authority"));
  at.revoke("kitchen");
  CHECK(has(why({"kitchen"}), "--new-key"));
  CHECK(why({"kitchen", 100, true}).empty());
  CHECK(why_unfit(at.files("kitchen"), "kitchen").empty()); // the new one is not revoked
}

TEST_CASE("a revoked certificate is told apart at both ends, whoever has the list", "[io][tls]") {
  const deployment at;
  const io::tls_keeper thief(at.add("me", certificate_use::coordinator));
  const io::tls_keeper lost(at.add("attic"));
  const auto kitchen = at.add("kitchen");
  const auto other = at.add("other", certificate_use::coordinator);
  CHECK(at.revoke("me") == 1);
  CHECK(at.revoke("attic") == 2);

  const io::tls_keeper host(kitchen, "kitchen");
  const io::tls_keeper coordinator(other);
  CHECK(host.revoked()->number() == 2);
  CHECK(host.revoked()->size() == 2);
  CHECK(meet(host, coordinator).server.empty());
  const auto met = meet(host, thief);
  CHECK(met.server == "has a certificate `me` that was revoked");
  CHECK(met.client == "rejected our certificate `me`: it was revoked");
  const auto posing = meet(lost, coordinator);
  CHECK(posing.client == "has a certificate `attic` that was revoked");
  CHECK(posing.server == "rejected our certificate `attic`: it was revoked");
  CHECK(has(why_unfit(at.files("attic"), "attic"), "revoked on 20"));
  const auto listed = good(io::list_certificates(at.path()));
  CHECK(listed[1].revoked);
  CHECK_FALSE(io::is_good(listed[1], io::system_time()));
  CHECK_FALSE(listed[2].revoked);
}

TEST_CASE("former certificates of a name are revoked with it", "[io][tls]") {
  const deployment at;
  const auto files = at.add("me", certificate_use::coordinator);
  at.add("me-too", certificate_use::coordinator);
  const io::tls_keeper before(files);
  good(io::renew_certificate(at.path(), {"me"}, io::system_time()));
  good(io::renew_certificate(at.path(), {"me-too"}, io::system_time()));
  CHECK(good(io::revoke_certificate(at.path(), "me", io::system_time())).added == 2);
  CHECK(has(refusal(io::revoke_certificate(at.path(), "me", io::system_time())), "already"));
  CHECK(has(refusal(io::revoke_certificate(at.path(), "ca", io::system_time())), "new folder"));
  CHECK(has(refusal(io::revoke_certificate(at.path(), "attic", io::system_time())), "No such"));
  const io::tls_keeper host(at.add("kitchen"), "kitchen");
  CHECK(has(meet(host, before).server, "revoked"));
  CHECK(meet(host, io::tls_keeper(at.files("me-too"))).server.empty());
}

TEST_CASE("a host takes newer lists only, and keeps them over its own end", "[io][tls]") {
  const deployment at;
  const auto kitchen = at.add("kitchen");
  const io::tls_keeper thief(at.add("me", certificate_use::coordinator));
  at.add("attic");
  at.add("shed");
  at.revoke("attic");
  const auto first = at.list();
  at.revoke("me");
  const auto second = at.list();
  at.remove_list();
  {
    io::tls_keeper host(kitchen, "kitchen", at.state());
    CHECK_FALSE(host.revoked());
    CHECK(meet(host, thief).server.empty());
    CHECK(host.take(first).is_taken);
    const auto taken = host.take(second);
    CHECK(taken.is_taken);
    CHECK(taken.report == "accepts list 2 of revoked certificates, with 2");
    CHECK(has(meet(host, thief).server, "revoked"));
    CHECK(host.take(second).report.empty());
    CHECK(has(host.take(first).report, "has number 1, and list 2"));
    CHECK(host.revoked()->number() == 2);
    CHECK(host.changes() == 0);
  }
  io::tls_keeper again(kitchen, "kitchen", at.state());
  CHECK(again.revoked()->number() == 2);
  CHECK(has(meet(again, thief).server, "revoked"));

  put(at.path() + "/ca.crl", first); // somebody has put an old one there
  const io::tls_keeper older(kitchen, "kitchen", at.state());
  CHECK(older.revoked()->number() == 2);
  REQUIRE(older.warnings().size() == 1);
  CHECK(has(older.warnings()[0], "older than list 2"));
  CHECK(has(again.look(), "has number 1"));

  at.revoke("shed"); // from a folder that has lost list 2: another one with its number
  CHECK(has(again.look(), "differs from but has the number of list 2"));
  CHECK_FALSE(again.take(at.list()).is_taken);
  CHECK(has(meet(again, thief).server, "revoked"));
}

TEST_CASE("a list that is forged, over, or none is refused, and the one in force holds",
          "[io][tls]") {
  const auto now = io::system_time();
  const deployment at(now - days(100), 400);
  const deployment others(now - days(100), 101);
  const auto kitchen = at.add("kitchen");
  const io::tls_keeper thief(at.add("me", certificate_use::coordinator));
  at.add("attic");
  at.revoke("me");
  const auto real = at.list();
  at.remove_list();
  io::tls_keeper host(kitchen, "kitchen", at.state());
  REQUIRE(host.take(real).is_taken);

  others.add("x");
  others.add("y");
  others.add("z");
  others.revoke("x");
  others.revoke("y");
  others.revoke("z");
  CHECK(has(host.take(others.list()).report, "is not signed by"));
  CHECK(has(host.take("garbage").report, "not a list of revoked certificates in PEM"));
  CHECK(has(host.take(std::string(200'000, 'x')).report, "too long"));
  CHECK(has(host.take("").report, "not a list"));
  for (std::size_t i = 40; i + 40 < real.size(); i += 7) { // each change of it is none of ours
    auto changed = real;
    changed[i] = changed[i] == 'A' ? 'B' : 'A';
    if (changed != real)
      CHECK_FALSE(host.take(changed).is_taken);
  }
  CHECK(host.revoked()->number() == 1);
  CHECK(has(meet(host, thief).server, "revoked"));

  // The list of an authority holds as long as this.
  const auto read = [&](std::chrono::sys_seconds when, bool may_be_over) {
    return refusal(io::revocation_list::read(real, kitchen.authority, when, may_be_over));
  };
  CHECK(read(now, false).empty());
  CHECK(has(read(now + days(301), false), "expired on"));
  CHECK(read(now + days(301), true).empty());
  CHECK(has(read(now - days(3), false), "only, and the clock here says"));

  put(at.path() + "/ca.crl", others.list());
  CHECK(has(why_unfit(kitchen, "kitchen"), "is not signed by"));
  CHECK(has(host.look(), "does not accept a list of revoked certificates"));
  const auto listed = good(io::list_certificates(at.path()));
  CHECK(listed.back().file == "ca.crl");
  CHECK(has(listed.back().problem, "is not signed by"));
  CHECK_FALSE(io::is_good(listed.back(), now));
}

TEST_CASE("a list that a host has kept and that is broken is no reason to believe everybody",
          "[io][tls]") {
  const deployment at;
  const auto kitchen = at.add("kitchen");
  at.add("me", certificate_use::coordinator);
  at.revoke("me");
  static_cast<void>(io::tls_keeper(kitchen, "kitchen", at.state()));
  at.remove_list();
  for (const auto& each : fs::directory_iterator(fs::path(at.state()).parent_path()))
    if (each.path().extension() == ".crl")
      put(each.path().string(), "");
  CHECK(has(why_unfit(kitchen, "kitchen", at.state()), "kitchen-"));
}

TEST_CASE("a list that takes back the own certificate is taken, and a new authority begins anew",
          "[io][tls]") {
  const deployment at;
  const deployment next;
  const auto kitchen = at.add("kitchen");
  io::tls_keeper host(kitchen, "kitchen", at.state());
  at.revoke("kitchen");
  const auto told = host.look();
  CHECK(has(told,
            "accepts list 1 of revoked certificates, with 1; its own certificate is among them"));
  CHECK(has(host.look(/*again=*/true), "keeps its certificate, since the new one is invalid"));
  const auto renewed = next.add("kitchen");
  at.remove_list();
  for (const auto file : {&tls_files::certificate, &tls_files::key, &tls_files::authority})
    fs::copy_file(renewed.*file, kitchen.*file, fs::copy_options::overwrite_existing);
  CHECK(has(host.look(), "uses the certificate"));
  CHECK_FALSE(host.revoked());
}

TEST_CASE("a certificate for both uses is accepted, and told", "[io][tls]") {
  const deployment at;
  const io::tls_keeper old(at.add("kitchen", certificate_use::any), "kitchen");
  REQUIRE(old.warnings().size() == 1);
  CHECK(has(old.warnings()[0], "valid both for a host and for a coordinator"));
  CHECK(meet(old, io::tls_keeper(at.add("me", certificate_use::coordinator))).server.empty());
  CHECK(io::tls_keeper(at.add("attic"), "attic").warnings().empty());
}
