// The bridge at a rosbridge on loopback that drops connections, sends garbage, and does not read.
#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "unit/bridge/bridged_peer.hpp"
#include "unit/bridge/fake_rosbridge.hpp"

using namespace rubicon;
using namespace rubicon::bridge;

TEST_CASE("a tuple comes back by a topic within milliseconds", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  test::bridged_peer x(server.port());
  REQUIRE(x.within([&] { return x.core().is_connected(); }));
  std::vector<double> times_ms;
  for (int i = 0; i < 500; ++i) {
    const auto text = std::to_string(i);
    const auto begin = test::ros2_clock::now();
    x.set(text);
    REQUIRE(x.within([&] { return x.echo == text; }));
    times_ms.push_back(
        std::chrono::duration<double, std::milli>(test::ros2_clock::now() - begin).count());
  }
  std::ranges::sort(times_ms);
  INFO("median " << times_ms[times_ms.size() / 2] << " ms");
  CHECK(times_ms[times_ms.size() / 2] < 50); // a busy machine; 5 ms are aimed at
}

TEST_CASE("a thousand values in a row come back by a topic", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  test::bridged_peer x(server.port());
  REQUIRE(x.within([&] { return x.core().is_connected(); }));
  for (int i = 0; i < 1000; ++i) {
    x.set(std::to_string(i));
    x.work();
  }
  CHECK(x.within([&] { return x.echo == "999"; }));
  CHECK(x.echoes + x.core().outbox().dropped() == 1000);
}

TEST_CASE("a server that is killed fifty times has all again after each", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  test::bridged_peer x(server.port());
  for (int life = 1; life <= 50; ++life) {
    INFO("life " << life);
    REQUIRE(x.within([&] { return x.core().is_connected(); }));
    const auto text = std::to_string(life);
    x.set(text);
    REQUIRE(x.within([&] { return x.echo == text; }));
    server.stop();
    REQUIRE(x.within([&] { return !x.core().is_connected(); }));
    server.start();
  }
  REQUIRE(x.within([&] { return x.core().is_connected(); }));
  CHECK(x.within([&] { return server.known().topics().contains("/value"); }));
  CHECK(x.within([&] { return server.known().topics().at("/value").newest == R"({"data":50})"; }));
  CHECK(x.core().counters().connections == 51);
}

TEST_CASE("a server that closes each connection is asked again, with pauses", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.set_refusing(true);
  server.start();
  test::bridged_peer x(server.port());
  CHECK(x.within([&] { return x.core().counters().failures == 3; }));
  CHECK(x.core().counters().connections == 0);
  server.set_refusing(false);
  CHECK(x.within([&] { return x.core().is_connected(); }));
}

TEST_CASE("garbage and messages of 10 MB are dropped, and the rest is read", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  test::bridged_peer x(server.port());
  REQUIRE(x.within([&] { return x.core().is_connected(); }));
  server.send_text("no JSON");
  server.send_text(R"({"op":"publish","topic":"/value","msg":)" + std::string(60'000, '['));
  server.send_text(std::string(10'000'000, 'x'));
  server.send_raw(test::fake_rosbridge::frame(0x82, "binary"));
  server.send_text(R"({"op":"publish","topic":"/unlisted","msg":{"data":1}})");
  server.send_text(R"({"op":"publish","topic":"/value","msg":{"data":7}})");
  CHECK(x.within([&] { return x.echo == "7"; }));
  CHECK(x.core().counters().malformed == 2);
  CHECK(x.core().counters().unlisted == 1);
  CHECK(x.client().oversized == 1);
  CHECK(x.client().not_text == 1);
  server.send_raw(std::string(100, '\xff')); // no WebSocket any more
  CHECK(x.within([&] { return x.core().counters().connections == 2; }));
}

TEST_CASE("a flood is read as fast as it may be and no faster, and its newest value wins",
          "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  test::bridged_peer x(server.port());
  REQUIRE(x.within([&] { return x.core().is_connected(); }));
  std::string flood;
  for (int i = 1; i <= 20'000; ++i)
    flood += test::fake_rosbridge::frame(
        0x81, R"({"op":"publish","topic":"/value","msg":{"data":)" + std::to_string(i) + "}}");
  server.send_raw(std::move(flood));
  CHECK(x.within([&] { return x.core().counters().received >= 20'000; }));
  CHECK(x.within([&] { return x.echo == "20000"; }));
  CHECK(x.core().counters().tuples_set + x.core().counters().flooded == 20'000);
}

TEST_CASE("a server that does not read makes nothing grow", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  test::bridged_peer x(server.port());
  REQUIRE(x.within([&] { return x.core().is_connected(); }));
  x.set("0");
  REQUIRE(x.within([&] { return x.echo == "0"; }));
  server.set_reading(false);
  for (int i = 1; i <= 200'000 && x.core().outbox().dropped() == 0; ++i) {
    x.set(std::to_string(i));
    x.work();
  }
  CHECK(x.core().outbox().dropped() > 0);
  CHECK(x.core().outbox().longest() <= 100);
  server.set_reading(true);
  x.set("-1"); // its echo comes within a flood, as the newest
  CHECK(x.within([&] { return x.echo == "-1"; }));
}
