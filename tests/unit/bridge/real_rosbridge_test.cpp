// The bridge at a rosbridge on loopback that drops connections, sends garbage, and does not read.
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bridge/ros2/ros2_bridge.hpp"
#include "core/overloads.hpp"
#include "io/tcp/web_client.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"
#include "unit/bridge/fake_rosbridge.hpp"

using namespace rubicon;
using namespace rubicon::bridge;

namespace {

using ros2_clock = std::chrono::steady_clock;

/// Far too long a wait is a failure.
constexpr auto ros2_wait_max = std::chrono::seconds(30);

ros2_config echoing_config() {
  ros2_config x;
  topic_publication out;
  out.key = "value";
  out.topic = "/value";
  out.type = "std_msgs/msg/Int64";
  out.queue = 100;
  x.publications.push_back(out);
  topic_subscription back;
  back.topic = "/value";
  back.key = "echo";
  back.type = "std_msgs/msg/Int64";
  x.subscriptions.push_back(back);
  return x;
}

/// Core and client, as their component joins them.
class bridged_peer {
public:
  explicit bridged_peer(std::uint16_t port)
      : core_(echoing_config(), random_stream(1)), client_({"127.0.0.1", port, "/"}, [this] {
          const std::lock_guard lock(mutex_);
          rang_ = true;
          rings_.notify_all();
        }) {
    perform(core_.start(now()));
  }

  void set(const std::string& text) {
    perform(core_.on_tuple({1, peer_id{1}, "value", text, false}, now()));
  }

  void work() {
    for (const auto& each : client_.take())
      std::visit(
          overloads{[this](const io::web_connected&) { perform(core_.on_connected(now())); },
                    [this](const io::web_disconnected& x) {
                      cause = x.cause;
                      perform(core_.on_disconnected(now()));
                    },
                    [this](const io::web_message& x) { perform(core_.on_text(x.text, now())); },
                    [this](const io::web_sent& x) { perform(core_.on_sent(x.count, now())); }},
          each);
    if (const auto due = core_.deadline(); due && *due <= now())
      perform(core_.on_time(now()));
  }

  /// Whether `done` is so in time.
  bool within(const std::function<bool()>& done) {
    const auto end = ros2_clock::now() + ros2_wait_max;
    while (true) {
      work();
      if (done())
        return true;
      if (ros2_clock::now() >= end)
        return false;
      std::unique_lock lock(mutex_);
      rings_.wait_for(lock, std::chrono::milliseconds(10),
                      [this] { return std::exchange(rang_, false); });
    }
  }

  [[nodiscard]] const ros2_bridge& core() const { return core_; }
  [[nodiscard]] io::web_client_counters client() const { return client_.counters(); }

  std::string echo;
  std::size_t echoes = 0;
  std::string cause;

private:
  [[nodiscard]] instant now() const {
    return test::start + std::chrono::duration_cast<duration>(ros2_clock::now() - began_);
  }

  void perform(ros2_outputs todo) {
    for (auto& each : todo)
      std::visit(overloads{[this](open_connection&) { client_.connect(); },
                           [this](ros2_text& x) { client_.send(std::move(x.text)); },
                           [this](components::publish& x) {
                             echo = to_string(byte_view(x.value));
                             ++echoes;
                           },
                           [](components::write&) {}},
                 each);
  }

  ros2_clock::time_point began_ = ros2_clock::now();
  std::mutex mutex_;
  std::condition_variable rings_;
  bool rang_ = false;
  ros2_bridge core_;
  io::web_client client_;
};

} // namespace

TEST_CASE("a tuple comes back by a topic within milliseconds", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  bridged_peer x(server.port());
  REQUIRE(x.within([&] { return x.core().is_connected(); }));
  std::vector<double> times_ms;
  for (int i = 0; i < 500; ++i) {
    const auto text = std::to_string(i);
    const auto begin = ros2_clock::now();
    x.set(text);
    REQUIRE(x.within([&] { return x.echo == text; }));
    times_ms.push_back(
        std::chrono::duration<double, std::milli>(ros2_clock::now() - begin).count());
  }
  std::ranges::sort(times_ms);
  INFO("median " << times_ms[times_ms.size() / 2] << " ms");
  CHECK(times_ms[times_ms.size() / 2] < 50); // a busy machine; 5 ms are aimed at
}

TEST_CASE("a thousand values in a row come back by a topic", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  bridged_peer x(server.port());
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
  bridged_peer x(server.port());
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
  bridged_peer x(server.port());
  CHECK(x.within([&] { return x.core().counters().failures == 3; }));
  CHECK(x.core().counters().connections == 0);
  server.set_refusing(false);
  CHECK(x.within([&] { return x.core().is_connected(); }));
}

TEST_CASE("garbage and messages of 10 MB are dropped, and the rest is read", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  bridged_peer x(server.port());
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

TEST_CASE("a flood is read as fast as it may be, and no faster", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  bridged_peer x(server.port());
  REQUIRE(x.within([&] { return x.core().is_connected(); }));
  std::string flood;
  for (int i = 0; i < 20'000; ++i)
    flood +=
        test::fake_rosbridge::frame(0x81, R"({"op":"publish","topic":"/value","msg":{"data":1}})");
  server.send_raw(std::move(flood));
  CHECK(x.within([&] { return x.core().counters().received >= 20'000; }));
  CHECK(x.core().counters().tuples_set + x.core().counters().flooded == 20'000);
}

TEST_CASE("a server that does not read makes nothing grow", "[bridge][ros2]") {
  test::fake_rosbridge server;
  server.start();
  bridged_peer x(server.port());
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
  auto again = ros2_clock::now(); // an echo within a flood is dropped
  CHECK(x.within([&] {
    if (ros2_clock::now() >= again) {
      x.set("-1");
      again += std::chrono::milliseconds(500);
    }
    return x.echo == "-1";
  }));
}
