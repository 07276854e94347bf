// Commands that were not told where: runs that left a note, default ports, announcements.
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include <unistd.h>

#include "cli/hosts/deployed.hpp"
#include "cli/network/find_network.hpp"
#include "cli/run/running_note.hpp"
#include "peer/standalone.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

/// On the loopback interface, away from the port of real ecologies and of other tests.
io::udp_group_config local_group() {
  return {.port = static_cast<std::uint16_t>(21'000 + ::getpid() % 2000),
          .interfaces = {"127.0.0.1"}};
}

/// A peer of some network at some port, driven on a thread of its own.
class some_peer {
public:
  some_peer(std::string network, bool announces)
      : network_(std::move(network)), announces_(announces), thread_([this] { drive(); }) {
    while (port_ == 0)
      std::this_thread::yield();
  }
  ~some_peer() {
    over_ = true;
    thread_.join();
  }

  [[nodiscard]] std::uint16_t port() const { return static_cast<std::uint16_t>(port_.load()); }
  [[nodiscard]] std::string url() const { return "tcp://127.0.0.1:" + std::to_string(port()); }

private:
  void drive() {
    io::loop loop;
    peer::standalone_config config;
    config.kernel.network.id = peer_id{7};
    config.kernel.network.network = network_;
    config.links.first_port = 0;
    config.links.lan = announces_;
    config.links.listen_address = "127.0.0.1";
    config.links.group = local_group();
    auto opened = peer::standalone::open(loop, config);
    auto& peer = *std::get<std::unique_ptr<peer::standalone>>(opened);
    port_ = *peer.links().port();
    while (!over_)
      peer.step(10ms);
    peer.leave();
  }

  std::string network_;
  bool announces_;
  std::atomic<unsigned> port_ = 0;
  std::atomic<bool> over_ = false;
  std::thread thread_; // last: it uses the others
};

/// Nobody's notes but those of the test.
class own_notes {
public:
  own_notes() { ::setenv("XDG_STATE_HOME", folder_.path.c_str(), 1); }
  ~own_notes() { ::unsetenv("XDG_STATE_HOME"); }

  void write(const std::string& process, const std::string& text) const {
    std::filesystem::create_directories(folder_.path / "rubicon");
    std::ofstream(folder_.path / "rubicon" / (process + ".running")) << text;
  }
  void write_deployed(const std::string& ecology, const std::string& text) const {
    std::filesystem::create_directories(folder_.path / "rubicon");
    std::ofstream(folder_.path / "rubicon" / (ecology + deployed_ending)) << text;
  }
  [[nodiscard]] bool has(const std::string& process) const {
    return std::filesystem::exists(folder_.path / "rubicon" / (process + ".running"));
  }

private:
  rubicon::test::scratch_folder folder_;
};

/// Nowhere.
search_area no_area() {
  search_area x;
  x.ports = 0;
  x.group = local_group();
  x.listen_for = 50ms;
  x.try_max = 20s; // others use the machine too
  return x;
}

config::ecology_description ecology_at(const std::string& network, std::uint16_t port) {
  config::ecology_description x;
  x.name = network + "-ecology";
  x.network = network;
  x.peers.emplace_back();
  x.peers.back().tcp.emplace();
  x.peers.back().tcp->port = port;
  return x;
}

} // namespace

TEST_CASE("a run in wall time leaves a note while it lives", "[cli][SVC-08]") {
  const own_notes notes;
  {
    const running_note note(ecology_at("home", 8123));
    const auto all = running_ecologies();
    REQUIRE(all.size() == 1);
    CHECK(all[0].name == "home-ecology");
    CHECK(all[0].network == "home");
    CHECK(all[0].urls == std::vector<std::string>{"tcp://127.0.0.1:8123"});
  }
  CHECK(running_ecologies().empty());
  const running_note closed{config::ecology_description{}}; // nobody can enter it
  CHECK(running_ecologies().empty());
}

TEST_CASE("notes of the dead are removed, and nonsense is passed over", "[cli]") {
  const own_notes notes;
  notes.write("4194304", R"({"ecology": "a", "network": "a", "urls": []})"); // above all pids
  notes.write("x1", R"({"ecology": "b", "network": "b", "urls": []})");
  notes.write(std::to_string(::getpid()), "{");
  CHECK(running_ecologies().empty());
  CHECK(!notes.has("4194304"));
  CHECK(!notes.has("x1"));
  notes.write(std::to_string(::getpid()), R"({"ecology": "c", "network": "c", "urls": "no"})");
  CHECK(running_ecologies().empty());
}

TEST_CASE("the note of a deployment has the PEIS links of its hosts", "[cli][SVC-08]") {
  const own_notes notes;
  deployed x;
  x.id = "1f";
  x.ecology = "house";
  x.network = "attic";
  x.hosts = {{"hall", "192.0.2.1", 4242, 4243}, {"study", "192.0.2.2", 4242, 0}};
  CHECK(remember(x).empty());
  const auto all = deployed_ecologies();
  REQUIRE(all.size() == 1);
  CHECK(all[0].network == "attic");
  CHECK(all[0].urls == std::vector<std::string>{"tcp://192.0.2.1:4243"});
}

TEST_CASE("the network of a deployment is found by the note of who has deployed it",
          "[cli][SVC-08]") {
  const own_notes notes;
  const some_peer peer("attic", false);
  notes.write_deployed("attic", R"({"ecology": "house", "network": "attic", "urls": [")" +
                                    peer.url() + R"("]})");
  notes.write_deployed("old", R"({"ecology": "old", "hosts": []})"); // of an earlier version
  CHECK(running_ecologies().empty());
  REQUIRE(deployed_ecologies().size() == 1);
  io::loop loop;
  network_options options;
  options.timeout = 20s;
  const auto found = join_network(loop, options, no_area());
  REQUIRE(std::holds_alternative<joined_network>(found));
  CHECK(std::get<joined_network>(found).with.network == "attic");
  options.peer = peer.url(); // with an address, but without the name
  const auto there = join_network(loop, options, no_area());
  REQUIRE(std::holds_alternative<joined_network>(there));
  CHECK(std::get<joined_network>(there).with.network == "attic");
  options.network = "cellar";
  options.network_given = true;
  const auto other = join_network(loop, options, no_area());
  REQUIRE(std::holds_alternative<std::string>(other));
  CHECK(std::get<std::string>(other).find("--network NAME") != std::string::npos);
}

TEST_CASE("a running ecology is joined without its place or its network's name", "[cli][SVC-08]") {
  const own_notes notes;
  const some_peer peer("attic", false);
  const running_note note(ecology_at("attic", peer.port()));
  io::loop loop;
  auto found = join_network(loop, {}, no_area());
  REQUIRE(std::holds_alternative<joined_network>(found));
  const auto& joined = std::get<joined_network>(found);
  CHECK(joined.with.network == "attic");
  CHECK(joined.with.peer == peer.url());
  CHECK(joined.with.timeout == network_options{}.timeout); // not the short one of the search
  CHECK(joined.self->peer().network().reachable(peer_id{7}));
}

TEST_CASE("default ports of this computer are tried", "[cli][SVC-08]") {
  const own_notes notes;
  const some_peer peer("rubicon", false);
  auto area = no_area();
  area.first_port = peer.port();
  area.ports = 1;
  io::loop loop;
  auto found = join_network(loop, {}, area);
  REQUIRE(std::holds_alternative<joined_network>(found));
  CHECK(std::get<joined_network>(found).with.network == "rubicon");
}

TEST_CASE("a network that announces itself is found, whatever its name", "[cli][SVC-08]") {
  const own_notes notes;
  const some_peer peer("cellar", true);
  auto area = no_area();
  area.listen_for = 20s;
  io::loop loop;
  auto found = join_network(loop, {}, area);
  if (const auto* why = std::get_if<std::string>(&found))
    FAIL(*why);
  CHECK(std::get<joined_network>(found).with.network == "cellar");
  network_options other;
  other.network = "other";
  other.network_given = true;
  area.listen_for = 1500ms;
  found = join_network(loop, other, area);
  REQUIRE(std::holds_alternative<std::string>(found));
  CHECK(std::get<std::string>(found).find("of the network `other`") != std::string::npos);
}

TEST_CASE("of several networks nobody guesses one", "[cli][SVC-08]") {
  const own_notes notes;
  const some_peer peer("attic", false);
  notes.write("1",
              R"({"ecology": "b", "network": "barn", "urls": []})"); // alive: the first process
  const running_note note(ecology_at("attic", peer.port()));
  io::loop loop;
  auto found = join_network(loop, {}, no_area());
  REQUIRE(std::holds_alternative<std::string>(found));
  CHECK(std::get<std::string>(found) ==
        "there are several networks: attic, barn; choose one with --network NAME");
  network_options options;
  options.network = "attic";
  options.network_given = true;
  found = join_network(loop, options, no_area());
  CHECK(std::holds_alternative<joined_network>(found));
}

TEST_CASE("who finds nothing says what to do", "[cli][SVC-08]") {
  const own_notes notes;
  io::loop loop;
  const auto found = join_network(loop, {}, no_area());
  REQUIRE(std::holds_alternative<std::string>(found));
  const auto& why = std::get<std::string>(found);
  CHECK(why.find("--connect HOST:PORT") != std::string::npos);
  CHECK(why.find("--lan") != std::string::npos);
}
