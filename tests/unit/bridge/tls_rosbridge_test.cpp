// The bridge at a rosbridge on loopback that is behind TLS, with certificates good and bad.
#include <string>
#include <variant>

#include "io/tls/certificates.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "unit/bridge/bridged_peer.hpp"
#include "unit/bridge/fake_rosbridge.hpp"
#include "unit/bridge/tls_front.hpp"

using namespace rubicon;

namespace {

/// Of an authority of its own.
struct certified {
  explicit certified(const std::string& address) {
    const auto now = io::system_time();
    REQUIRE(std::holds_alternative<io::made_certificate>(
        io::make_authority(folder.path.string(), {}, now)));
    REQUIRE(std::holds_alternative<io::made_certificate>(io::make_certificate(
        folder.path.string(), {"bridge", {address}, 10, io::certificate_use::host}, now)));
  }

  [[nodiscard]] std::string authority() const { return folder.file("ca.crt"); }
  [[nodiscard]] std::string file() const { return folder.file("bridge.crt"); }
  [[nodiscard]] std::string key() const { return folder.file("bridge.key"); }

  test::scratch_folder folder;
};

io::web_client_settings through_tls(const std::string& host, const test::tls_front& at,
                                    const std::string& ca_file) {
  io::web_client_settings x{host, at.port(), "/"};
  x.tls = true;
  x.ca_file = ca_file;
  return x;
}

/// A server with this certificate, and a bridge that believes an authority.
struct secure_pair {
  secure_pair(const certified& shown, const std::string& host, const std::string& ca_file,
              bool verify = true)
      : front(shown.file(), shown.key(), server.port()), peer([&] {
          server.start();
          auto settings = through_tls(host, front, ca_file);
          settings.verify = verify;
          return settings;
        }()) {}

  [[nodiscard]] bool carries_values() {
    if (!peer.within([&] { return peer.core().is_connected(); }))
      return false;
    for (int i = 0; i < 200; ++i) {
      peer.set(std::to_string(i));
      if (!peer.within([&] { return peer.echo == std::to_string(i); }))
        return false;
    }
    return true;
  }

  /// In its words.
  [[nodiscard]] std::string refusal() {
    static_cast<void>(peer.within([&] { return !peer.cause.empty(); }));
    return peer.core().is_connected() ? "connected" : peer.cause;
  }

  test::fake_rosbridge server;
  test::tls_front front;
  test::bridged_peer peer;
};

} // namespace

TEST_CASE("a tuple comes back through TLS from a server that proves who it is", "[bridge][ros2]") {
  const certified by_address("127.0.0.1");
  secure_pair x(by_address, "127.0.0.1", by_address.authority());
  CHECK(x.carries_values());
  CHECK(x.front.came() > 200);
  const certified by_name("localhost");
  secure_pair y(by_name, "localhost", by_name.authority());
  CHECK(y.carries_values());
}

TEST_CASE("a server that does not prove who it is gets nothing, and the cause is said",
          "[bridge][ros2]") {
  const certified good("127.0.0.1");
  const certified of_another("10.0.0.1");
  SECTION("an authority that nobody here knows") {
    secure_pair x(good, "127.0.0.1", of_another.authority());
    CHECK(x.refusal().find("the certificate of 127.0.0.1 is not believed: ") == 0);
    CHECK(x.front.came() == 0);
  }
  SECTION("none of those that the system knows") {
    secure_pair x(good, "127.0.0.1", "");
    CHECK(x.refusal().find("the certificate of 127.0.0.1 is not believed: ") == 0);
  }
  SECTION("another address") {
    secure_pair x(of_another, "127.0.0.1", of_another.authority());
    CHECK(x.refusal() == "the certificate of 127.0.0.1 is not believed: IP address mismatch");
  }
  SECTION("another name") {
    secure_pair x(good, "localhost", good.authority());
    CHECK(x.refusal() == "the certificate of localhost is not believed: hostname mismatch");
  }
  SECTION("a file that has no certificates") {
    secure_pair x(good, "127.0.0.1", good.key());
    CHECK(x.refusal() == "no certificates can be read from " + good.key());
  }
  SECTION("unless nobody is to verify it") {
    secure_pair x(of_another, "127.0.0.1", "", /*verify=*/false);
    CHECK(x.carries_values());
  }
}

TEST_CASE("a server without TLS is none with it, and the other way round", "[bridge][ros2]") {
  test::fake_rosbridge plain;
  plain.set_refusing(true);
  plain.start();
  io::web_client_settings to{"127.0.0.1", plain.port(), "/"};
  to.tls = true;
  test::bridged_peer x(to);
  REQUIRE(x.within([&] { return !x.cause.empty(); }));
  CHECK(x.cause.find("no TLS with 127.0.0.1:" + std::to_string(plain.port()) + ": ") == 0);

  const certified good("127.0.0.1");
  const test::tls_front front(good.file(), good.key(), plain.port());
  test::bridged_peer y(front.port());
  CHECK(y.within([&] { return !y.cause.empty(); }));
  CHECK(!y.core().is_connected());
}
