// Both ends of TLS without a network, and what makes a certificate unfit to begin with.
#include "io/tls/tls_session.hpp"

#include <chrono>
#include <filesystem>

#include "io/tls/certificates.hpp"
#include "io/tls/tls_keeper.hpp"
#include "unit/io/certificates_fixture.hpp"
#include "unit/io/tls_fixture.hpp"

using namespace rubicon;
using namespace rubicon::test;
using io::tls_files;
using io::tls_identity;
using io::tls_session;
using std::chrono::days;
using phase = io::tls_session::phase;
using side = io::tls_session::side;

namespace {

/// An authority with certificates, at a time.
class authority {
public:
  explicit authority(std::chrono::sys_seconds now = io::system_time(), unsigned length = 3652) {
    good(io::make_authority(path(), {"flat", length}, now));
  }

  tls_files add(const std::string& name, std::chrono::sys_seconds now = io::system_time(),
                unsigned length = 100, io::certificate_use use = io::certificate_use::any) const {
    good(io::make_certificate(path(), {name, {}, length, use}, now));
    return files(name);
  }

  [[nodiscard]] tls_files files(const std::string& name) const {
    return {path() + '/' + name + ".crt", path() + '/' + name + ".key", path() + "/ca.crt"};
  }

private:
  [[nodiscard]] std::string path() const { return (folder_.path / "certs").string(); }

  const scratch_folder folder_;
};

tls_identity identity(const tls_files& x, std::chrono::sys_seconds now = io::system_time()) {
  return good(tls_identity::load(x, now));
}

} // namespace

TEST_CASE("two ends with certificates of one authority talk, in any pieces", "[io][tls]") {
  const authority ours;
  tls_session server(identity(ours.add("kitchen")), side::server);
  tls_session client(identity(ours.add("me")), side::client, "kitchen");
  talk(client, server);
  REQUIRE(server.now() == phase::open);
  REQUIRE(client.now() == phase::open);
  CHECK(server.peer_name() == "me");
  CHECK(client.peer_name() == "kitchen");

  client.send(bytes(100'000, 'x'));
  const auto sent = client.outgoing();
  bytes heard;
  for (const auto octet : sent) {
    const auto said = server.take(bytes{octet});
    heard.insert(heard.end(), said.begin(), said.end());
  }
  CHECK(heard == bytes(100'000, 'x'));
  client.close();
  static_cast<void>(server.take(client.outgoing()));
  CHECK(server.why() == "closed the connection");
}

TEST_CASE("who is not believed is told apart, at both ends", "[io][tls]") {
  const auto now = io::system_time();
  const authority ours(now - days(400));
  const authority others(now - days(400));
  const auto kitchen = identity(ours.add("kitchen"));
  const auto me = identity(ours.add("me"));

  const auto foreign = meet(kitchen, identity(others.add("me")));
  CHECK(has(foreign.client, "has a certificate `kitchen` of another authority"));
  CHECK(has(foreign.server,
            "rejected our certificate `kitchen`: it was signed by another authority"));

  const auto old = now - days(300);
  const auto expired = meet(kitchen, identity(ours.add("old", old), old));
  CHECK(has(expired.server, "has a certificate `old` that expired on "));
  CHECK(has(expired.server, "the clock here shows "));
  CHECK(has(expired.client, "rejected our certificate `old`: it expired on "));
  const auto expired_host = meet(identity(ours.add("host", old), old), me);
  CHECK(has(expired_host.client, "has a certificate `host` that expired on "));

  const auto later = now + days(20);
  const auto early = meet(kitchen, identity(ours.add("early", later), later));
  CHECK(has(early.server, "`early` that is valid from "));
  CHECK(has(early.server, "one of the two clocks is wrong"));
  CHECK(has(early.client, "it is not yet valid there"));

  const auto other = meet(identity(ours.add("bedroom")), me, "kitchen");
  CHECK(has(other.client, "presented the certificate of `bedroom`, not of `kitchen`"));
  CHECK(has(other.server, "it expects another host"));
}

TEST_CASE("a host's certificate is no coordinator's, and the other way round", "[io][tls]") {
  const authority ours;
  const auto add = [&](const std::string& name, io::certificate_use use) {
    return ours.add(name, io::system_time(), 100, use);
  };
  const auto kitchen = identity(add("kitchen", io::certificate_use::host));
  const auto me = identity(add("me", io::certificate_use::coordinator));
  CHECK(meet(kitchen, me, "kitchen").server.empty());
  const auto other = meet(kitchen, identity(add("bedroom", io::certificate_use::host)), "kitchen");
  CHECK(has(other.server, "`bedroom` that is not a coordinator's: it may not deploy"));
  CHECK(has(other.client, "rejected our certificate `bedroom`: it is not a coordinator's"));
  const auto posing = meet(me, identity(ours.add("both")), "me");
  CHECK(has(posing.client, "`me` that is not a host's"));
  CHECK(has(refusal(tls_identity::load(ours.files("me"), io::system_time(), "me")),
            "not the certificate of a host"));
}

TEST_CASE("what is no TLS, and who shows no certificate, get nowhere", "[io][tls]") {
  const authority ours;
  const auto kitchen = identity(ours.add("kitchen"));
  tls_session plain(kitchen, side::server);
  static_cast<void>(plain.take(bytes(64, 'R')));
  REQUIRE(plain.now() == phase::closed);
  CHECK(has(plain.why(), "does not speak TLS"));

  tls_session client(identity(ours.add("me")), side::client);
  static_cast<void>(client.outgoing());
  static_cast<void>(client.take(to_bytes(std::string_view("this is a rubicon host\n"))));
  REQUIRE(client.now() == phase::closed);
  CHECK(has(client.why(), "does not speak TLS"));

  tls_session cut(kitchen, side::server);
  tls_session other(identity(ours.files("me")), side::client);
  const auto hello = other.outgoing();
  static_cast<void>(cut.take(byte_view(hello).first(hello.size() - 1)));
  CHECK(cut.now() == phase::shaking);
  CHECK(cut.outgoing().empty());
}

TEST_CASE("an identity that cannot be good is refused before it is used", "[io][tls]") {
  const auto now = io::system_time();
  const authority ours(now - days(400));
  const authority others;
  const auto why = [&](const tls_files& x, const std::string& name = {}) {
    return refusal(tls_identity::load(x, now, name));
  };
  const auto kitchen = ours.add("kitchen");
  CHECK(why(kitchen, "kitchen").empty());
  CHECK(
      has(why(kitchen, "bedroom"), "kitchen.crt: the certificate of `kitchen`, not of `bedroom`"));
  const auto me = ours.add("me");
  CHECK(has(why({kitchen.certificate, me.key, kitchen.authority}), "me.key: not the key of "));
  CHECK(has(why({kitchen.certificate, kitchen.key, others.files("x").authority}), "not signed by"));
  CHECK(has(why({kitchen.certificate, kitchen.key, me.certificate}),
            "not the certificate of an authority"));
  CHECK(has(why(ours.add("old", now - days(300))), "expired on"));
  CHECK(has(why(ours.add("early", now + days(20))), "only, and the clock of this computer shows"));
  CHECK(has(why({"/nowhere/a.crt", kitchen.key, kitchen.authority}), "No such file"));
  fs::permissions(kitchen.key, fs::perms::owner_read | fs::perms::others_read);
  CHECK(has(why(kitchen), "other users may read or change this key (mode 0404)"));
}

TEST_CASE("a new certificate is taken once it is good, and the old one holds until then",
          "[io][tls]") {
  const authority ours;
  const auto files = ours.add("kitchen");
  io::tls_keeper keeper(files, "kitchen");
  const auto until = keeper.identity()->valid_until();
  CHECK(keeper.look().empty());

  const authority scratch;
  const auto renewed = scratch.add("kitchen", io::system_time(), 500);
  put(files.certificate, "");
  CHECK(has(keeper.look(), "keeps its certificate, since the new one is invalid: "));
  CHECK(keeper.look().empty()); // told once
  CHECK(keeper.identity()->valid_until() == until);
  fs::copy_file(renewed.certificate, files.certificate, fs::copy_options::overwrite_existing);
  CHECK(has(keeper.look(), "not the key of"));
  fs::copy_file(renewed.key, files.key, fs::copy_options::overwrite_existing);
  CHECK(has(keeper.look(), "not signed by"));
  CHECK(keeper.changes() == 0);
  fs::copy_file(renewed.authority, files.authority, fs::copy_options::overwrite_existing);
  CHECK(has(keeper.look(), "uses the certificate"));
  CHECK(keeper.identity()->valid_until() > until);
  CHECK(keeper.changes() == 1);
  CHECK_FALSE(keeper.look(/*again=*/true).empty());
}
