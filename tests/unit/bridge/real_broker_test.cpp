// The bridge at a mosquitto on loopback, which is killed again and again. It is not tested where
// none is installed.
#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bridge/mqtt/mqtt_bridge.hpp"
#include "core/overloads.hpp"
#include "io/mqtt/mqtt_client.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/start.hpp"
#include "unit/bridge/classes.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::bridged_news;

namespace {

using steady = std::chrono::steady_clock; // not `clock`: <ctime> has a function of that name

/// Far too long a wait is a failure.
constexpr auto wait_max = std::chrono::seconds(20);

constexpr const char* mosquitto_path = "/usr/sbin/mosquitto";
/// How often the broker is killed: RUBICON_BROKER_LIVES instead of 5.
int broker_lives() {
  const char* const given = std::getenv("RUBICON_BROKER_LIVES");
  return given == nullptr ? 5 : std::max(1, std::atoi(given));
}

constexpr std::string_view online_text = R"({"state":"online"})";

std::uint16_t free_tcp_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  REQUIRE(socket >= 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  REQUIRE(::bind(socket, reinterpret_cast<sockaddr*>(&at), size) == 0);
  REQUIRE(::getsockname(socket, reinterpret_cast<sockaddr*>(&at), &size) == 0);
  ::close(socket);
  return ntohs(at.sin_port);
}

class real_broker {
public:
  real_broker(std::uint16_t port, const std::string& more) {
    std::ofstream file(config());
    file << "listener " << port << " 127.0.0.1\n" << more;
  }
  ~real_broker() { kill(); }
  real_broker(const real_broker&) = delete;
  real_broker& operator=(const real_broker&) = delete;

  void begin() {
    auto path = config();
    std::string program = mosquitto_path;
    std::string option = "-c";
    const std::array<char*, 4> words{program.data(), option.data(), path.data(), nullptr};
    posix_spawn_file_actions_t actions{};
    posix_spawn_file_actions_init(&actions);
    for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO})
      posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_WRONLY, 0);
    REQUIRE(::posix_spawn(&process_, mosquitto_path, &actions, nullptr, words.data(), environ) ==
            0);
    posix_spawn_file_actions_destroy(&actions);
  }

  void kill() {
    if (process_ <= 0)
      return;
    ::kill(process_, SIGKILL);
    ::waitpid(std::exchange(process_, -1), nullptr, 0);
  }

private:
  [[nodiscard]] std::string config() const { return folder_.file("mosquitto.conf"); }

  test::scratch_folder folder_;
  pid_t process_ = -1;
};

io::mqtt_client_settings settings_of(std::uint16_t port, const std::string& id) {
  io::mqtt_client_settings x;
  x.host = "127.0.0.1";
  x.port = port;
  x.client = id;
  x.will_topic = id + "/ended";
  x.will_payload = "yes";
  return x;
}

/// What wakes the test's thread.
struct bell {
  std::mutex mutex;
  std::condition_variable rings;

  void ring() {
    const std::lock_guard lock(mutex);
    rings.notify_all();
  }
};

/// All that it has received last, by topic.
class observer {
public:
  observer(std::uint16_t port, const std::string& id, bell& on_event)
      : client_(settings_of(port, id), [&on_event] { on_event.ring(); }) {}

  void work() {
    for (const auto& each : client_.take())
      std::visit(overloads{[this](const io::mqtt_connected&) {
                             ++connections;
                             seen.clear();
                             client_.subscribe("#");
                           },
                           [this](const io::mqtt_disconnected& x) { cause = x.cause; },
                           [this](const io::mqtt_message& x) {
                             seen[x.topic] = x.payload;
                             longest = std::max(longest, x.payload.size());
                           }},
                 each);
  }

  io::mqtt_client& client() { return client_; }

  std::map<std::string, std::string> seen;
  std::string cause;
  int connections = 0;
  std::size_t longest = 0;

private:
  io::mqtt_client client_;
};

class bridged_home {
public:
  bridged_home(std::uint16_t port, bell& on_event)
      : core_({}, test::bridged_classes(), random_stream(1)) {
    auto settings = settings_of(port, "bridge");
    settings.will_topic = core_.last_will().topic;
    settings.will_payload = core_.last_will().payload;
    client_ = std::make_unique<io::mqtt_client>(settings, [&on_event] { on_event.ring(); });
  }

  void set(const std::string& key, const std::string& text) {
    perform(core_.on_tuple(bridged_news(key, text), now()));
  }

  void work() {
    for (const auto& each : client_->take())
      std::visit(
          overloads{[this](const io::mqtt_connected&) { perform(core_.on_connected(now())); },
                    [this](const io::mqtt_disconnected&) { core_.on_disconnected(); },
                    [this](const io::mqtt_message& x) {
                      perform(core_.on_message({x.topic, x.payload, x.retained}, now()));
                    }},
          each);
    if (const auto due = core_.deadline(); due && *due <= now())
      perform(core_.on_time(now()));
  }

  std::vector<std::string> written;

private:
  [[nodiscard]] instant now() const {
    return test::start + std::chrono::duration_cast<duration>(steady::now() - began_);
  }

  void perform(mqtt_outputs todo) {
    for (auto& each : todo)
      std::visit(
          overloads{[this](subscription& x) { client_->subscribe(x.topic); },
                    [this](unsubscription& x) { client_->unsubscribe(x.topic); },
                    [this](publication& x) { client_->publish(x.topic, x.payload); },
                    [](components::publish&) {},
                    [this](components::write& x) { written.push_back(x.key + '=' + x.text); }},
          each);
  }

  steady::time_point began_ = steady::now();
  mqtt_bridge core_;
  std::unique_ptr<io::mqtt_client> client_;
};

/// Whether `done` is so within that time.
bool within(steady::duration most, bell& on_event, const std::function<void()>& work,
            const std::function<bool()>& done) {
  const auto end = steady::now() + most;
  while (true) {
    work();
    if (done())
      return true;
    std::unique_lock lock(on_event.mutex);
    if (steady::now() >= end)
      return false;
    on_event.rings.wait_for(lock, std::chrono::milliseconds(20));
  }
}

bool is_broker_installed() {
  if (::access(mosquitto_path, X_OK) == 0)
    return true;
  WARN("mosquitto is not installed");
  return false;
}

} // namespace

TEST_CASE("all is at a real broker again after each of its starts", "[bridge][mqtt]") {
  if (!is_broker_installed())
    return;
  const auto port = free_tcp_port();
  real_broker broker(port, "allow_anonymous true\n");
  bell events;
  observer home(port, "home", events);
  bridged_home bridge(port, events);
  bridge.set("kitchen.f.class", "fan");
  bridge.set("kitchen.f.status", "active");
  const auto work = [&] {
    home.work();
    bridge.work();
  };
  const int lives = broker_lives();
  for (int life = 1; life <= lives; ++life) {
    INFO("life " << life);
    broker.begin();
    bridge.set("kitchen.f.rssi", std::to_string(-life));
    CHECK(within(wait_max, events, work, [&] {
      const auto state = home.seen.find("rubicon/kitchen.f");
      return home.connections == life && state != home.seen.end() &&
             state->second.find("\"rssi\":-" + std::to_string(life)) != std::string::npos &&
             home.seen["rubicon/kitchen.f/availability"] == online_text &&
             home.seen["rubicon/bridge/state"] == online_text &&
             home.seen.contains("homeassistant/device/rubicon-skitchen_f/config");
    }));
    home.client().publish("rubicon/kitchen.f/set/switch", "on"); // retained, as all of this client
    CHECK(within(wait_max, events, work,
                 [&] { return bridge.written.size() == static_cast<std::size_t>(life); }));
    broker.kill();
    CHECK(within(wait_max, events, work, [&] { return !home.cause.empty(); }));
    home.cause.clear();
  }
  CHECK(bridge.written.size() == static_cast<std::size_t>(lives));
}

TEST_CASE("the will of a bridge that ends is published, and payloads of 10 MB do not arrive",
          "[bridge][mqtt]") {
  if (!is_broker_installed())
    return;
  const auto port = free_tcp_port();
  real_broker broker(port, "allow_anonymous true\n");
  broker.begin();
  bell events;
  observer home(port, "home", events);
  auto other = std::make_unique<observer>(port, "other", events);
  const auto work = [&] {
    home.work();
    if (other)
      other->work();
  };
  REQUIRE(within(wait_max, events, work,
                 [&] { return home.connections == 1 && other->connections == 1; }));
  other->client().publish("large", std::string(10'000'000, 'x'));
  other->client().publish("small", "x");
  CHECK(within(wait_max, events, work, [&] { return home.seen.contains("small"); }));
  CHECK(!home.seen.contains("large"));
  CHECK(home.longest < io::mqtt_client::payload_max);
  other.reset();
  CHECK(within(wait_max, events, work, [&] { return home.seen.contains("other/ended"); }));
}

TEST_CASE("a client without the password is refused, and says so once", "[bridge][mqtt]") {
  if (!is_broker_installed())
    return;
  const auto port = free_tcp_port();
  real_broker broker(port, "allow_anonymous false\n");
  broker.begin();
  bell events;
  observer home(port, "home", events);
  const auto work = [&] { home.work(); };
  // It may have tried before the broker listened.
  CHECK(within(wait_max, events, work, [&] { return !home.cause.empty(); }));
  CHECK(home.connections == 0);
}

TEST_CASE("a refusal is reported also if the broker could not be reached before",
          "[bridge][mqtt]") {
  if (!is_broker_installed())
    return;
  const auto port = free_tcp_port();
  real_broker broker(port, "allow_anonymous false\n");
  bell events;
  observer home(port, "home", events);
  const auto work = [&] { home.work(); };
  CHECK(within(wait_max, events, work, [&] { return !home.cause.empty(); }));
  CHECK(home.cause.find("refused by the broker") == std::string::npos);
  broker.begin();
  CHECK(within(wait_max, events, work,
               [&] { return home.cause.find("refused by the broker") != std::string::npos; }));
  CHECK(home.client().counters().refused == 1);
  CHECK(home.client().counters().lost == 0);
}

TEST_CASE("two clients of one id do not end each other's connections without pause",
          "[bridge][mqtt]") {
  if (!is_broker_installed())
    return;
  const auto port = free_tcp_port();
  real_broker broker(port, "allow_anonymous true\n");
  broker.begin();
  bell events;
  observer one(port, "home", events);
  observer other(port, "home", events);
  const auto work = [&] {
    one.work();
    other.work();
  };
  CHECK(!within(std::chrono::seconds(6), events, work, [] { return false; }));
  // With pauses of 250 ms there would be twenty.
  CHECK(one.client().counters().attempts + other.client().counters().attempts <= 12);
}
