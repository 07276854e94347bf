// The commands that look into a network, as a user meets them, against two peers on loopback.
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <variant>

#include <nlohmann/json.hpp>

#include "peer/standalone.hpp"
#include "support/catch.hpp"
#include "support/shell.hpp"

using namespace rubicon;
using rubicon::test::outcome;
using rubicon::test::shell;

namespace {

/// Peer 7 with a few tuples, driven on a thread of its own from first to last.
class lonely_peer {
public:
  lonely_peer() {
    thread_ = std::thread([this] { drive(); });
    while (port_ == 0)
      std::this_thread::yield();
  }
  ~lonely_peer() {
    over_ = true;
    thread_.join();
  }

  [[nodiscard]] std::string at() const {
    return " --connect 127.0.0.1:" + std::to_string(port_) + ' ';
  }

private:
  void drive() {
    io::loop loop;
    peer::standalone_config config;
    config.kernel.network.id = peer_id{7};
    config.kernel.network.name = "lonely";
    config.kernel.network.network = "rubicon";
    config.links.first_port = 0;
    auto opened = peer::standalone::open(loop, config);
    auto& peer = *std::get<std::unique_ptr<peer::standalone>>(opened);
    static_cast<void>(peer.set_tuple("room.temp", peis::text_content("21.5")));
    static_cast<void>(peer.set_tuple("room.scan", peis::binary_content(bytes{0, 255})));
    // As a proxy's input: the lamp can be switched on, and nothing else.
    static_cast<void>(peer.set_tuple("lamp.switch.deadline", peis::text_content("5.0")));
    static_cast<void>(peer.set_tuple("lamp.switch.outcome", peis::text_content("on failed")));
    static_cast<void>(peer.subscribe(peer_id{7}, "lamp.switch", [&peer](const auto& x) {
      const std::string word(x->text());
      if (word != "forever")
        static_cast<void>(peer.set_tuple(
            "lamp.switch.outcome",
            peis::text_content(word + (word == "on" ? " acknowledged" : " refused"))));
    }));
    port_ = *peer.links().port();
    while (!over_)
      peer.step(10ms);
    peer.leave();
  }

  std::atomic<unsigned> port_ = 0;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

const std::string rubicon_binary = RUBICON_BINARY;

outcome standard_output(const std::string& arguments) {
  return shell('"' + rubicon_binary + "\" " + arguments + " 2>/dev/null");
}

outcome standard_error(const std::string& arguments) {
  return shell('"' + rubicon_binary + "\" " + arguments + " 2>&1 >/dev/null");
}

} // namespace

TEST_CASE("tuples of a running peer are read and written", "[cli][SVC-07][SVC-08]") {
  const lonely_peer peer;
  CHECK(standard_output("tuples get room.temp --owner 7" + peer.at()).out == "21.5\n");
  CHECK(standard_output("tuples get room.scan --owner 7" + peer.at()).out == "00ff\n");
  CHECK(standard_output("tuples set room.temp 22 --owner 7" + peer.at()).status == 0);
  CHECK(standard_output("tuples append room.temp .5 --owner 7" + peer.at()).status == 0);
  const auto x = nlohmann::json::parse(
      standard_output("tuples get room.temp --owner 7 --json" + peer.at()).out);
  CHECK(x.at("value") == "22.5");
  CHECK(x.at("owner") == 7);
  const auto all = nlohmann::json::parse(standard_output("tuples ls --json" + peer.at()).out);
  REQUIRE(all.size() == 4); // without kernel.*
  CHECK(all[2].at("key") == "room.scan");
  CHECK(all[2].at("value_hex") == "00ff");
  const auto table = standard_output("tuples ls 'room.*'" + peer.at());
  CHECK(table.status == 0);
  CHECK(table.out.find("22.5") != std::string::npos);
}

TEST_CASE("setting a proxy's input waits for its outcome, if asked to", "[cli][SVC-07][IF-07]") {
  const lonely_peer peer;
  const auto set = [&](const std::string& words) {
    return shell('"' + rubicon_binary + "\" tuples set " + words + " --owner 7" + peer.at() +
                 " 2>&1");
  };
  const auto good = set("lamp.switch on --wait");
  CHECK(good.status == 0);
  CHECK(good.out == "acknowledged\n"); // not the older `failed`
  const auto bad = set("lamp.switch 'half on' --wait");
  CHECK(bad.status == 1);
  CHECK(bad.out == "refused\n");
  const auto json = set("lamp.switch on --wait --json");
  CHECK(json.status == 0);
  CHECK(nlohmann::json::parse(json.out).at("outcome") == "acknowledged");
  const auto none = set("room.temp 22 --wait --timeout 300ms");
  CHECK(none.status == 1);
  CHECK(none.out.find("room.temp.deadline") != std::string::npos);
  CHECK(standard_output("tuples get room.temp --owner 7" + peer.at()).out == "21.5\n");
  const auto late = set("lamp.switch forever --wait --timeout 500ms");
  CHECK(late.status == 1);
  CHECK(late.out.find("no") != std::string::npos);
  CHECK(set("lamp.switch on").out.empty());
}

TEST_CASE("a tuple of a running peer is deleted", "[cli][SVC-07]") {
  const lonely_peer peer;
  CHECK(standard_output("tuples delete room.temp --owner 7" + peer.at()).status == 0);
  CHECK(standard_output("tuples get room.temp --owner 7 --timeout 300ms" + peer.at()).status == 1);
  const auto x = standard_output("tuples delete room.scan --owner 7 --json" + peer.at());
  CHECK(nlohmann::json::parse(x.out).at("acknowledged") == true);
  CHECK(standard_error("tuples ls 'room.*' --timeout 300ms" + peer.at()).out ==
        "rubicon: nobody has a tuple `room.*`\n");
  CHECK(standard_error("tuples delete room.temp --owner 8 --timeout 300ms" + peer.at()).status ==
        1);
}

TEST_CASE("meta tuples are shown with what they point at, and pointed elsewhere", "[cli][SVC-07]") {
  const lonely_peer peer;
  const auto meta = [&](const std::string& words) {
    return standard_output("tuples meta " + words + " --owner 7" + peer.at());
  };
  CHECK(meta("mi-light room.temp").status == 0);
  CHECK(meta("mi-light").out == "7 room.temp  21.5\n");
  const auto x = nlohmann::json::parse(meta("mi-light --json").out);
  CHECK(x.at("key") == "mi-light");
  CHECK(x.at("target").at("key") == "room.temp");
  CHECK(x.at("target").at("value") == "21.5");
  CHECK(meta("mi-light room.fan --at 9").status == 0);
  CHECK(meta("mi-light --timeout 300ms").out == "9 room.fan  (no such tuple)\n");
  CHECK(meta("mi-light --nowhere").status == 0);
  CHECK(meta("mi-light").out == "nowhere\n");
  CHECK(standard_error("tuples meta room.temp --owner 7" + peer.at()).out ==
        "rubicon: tuple `room.temp` of peer 7 is no meta tuple\n");
  CHECK(meta("mi-light room.temp --nowhere").status == 2);
}

TEST_CASE("changes are watched until enough have come", "[cli][SVC-07]") {
  const lonely_peer peer;
  const auto x = standard_output("tuples watch 'room.*' --count 2 --for 20s --json" + peer.at());
  CHECK(x.status == 0);
  const auto end = x.out.find('\n');
  CHECK(nlohmann::json::parse(x.out.substr(0, end)).at("owner") == 7);
  CHECK(nlohmann::json::parse(x.out.substr(end)).at("owner") == 7);
  CHECK(standard_error("tuples watch nothing --count 1 --for 100ms" + peer.at()).status == 1);
}

TEST_CASE("hosts and ways to them are shown", "[cli][API-01][API-12]") {
  const lonely_peer peer;
  const auto hosts = nlohmann::json::parse(standard_output("hosts --json" + peer.at()).out);
  REQUIRE(hosts.size() == 1);
  CHECK(hosts[0].at("id") == 7);
  CHECK(hosts[0].at("name").get<std::string>().starts_with("lonely@"));
  CHECK(standard_output("hosts" + peer.at()).out.find("lonely@") != std::string::npos);
  const auto way =
      nlohmann::json::parse(standard_output("route 7 --id 60123 --json" + peer.at()).out);
  CHECK(way.at("route") == nlohmann::json({60123, 7, 60123}));
  const auto ping = standard_output("ping 7 --count 2" + peer.at());
  CHECK(ping.status == 0);
  CHECK(ping.out.find("2 hops there and back") != std::string::npos);
}

TEST_CASE("what cannot be done is told in one line, with status 1", "[cli]") {
  const lonely_peer peer;
  const auto one_line = [](const outcome& x, const std::string& text) {
    CAPTURE(x.out);
    CHECK(x.status == 1);
    CHECK(x.out == "rubicon: " + text + '\n');
  };
  const auto quick = " --timeout 300ms" + peer.at();
  one_line(standard_error("tuples get room.fan --owner 7" + quick),
           "peer 7 has no tuple `room.fan`");
  one_line(standard_error("tuples get room.fan" + quick), "nobody has a tuple `room.fan`");
  one_line(standard_error("tuples set a b --owner 8" + quick),
           "no peer 8 in the network `rubicon`");
  one_line(standard_error("ping 8" + quick), "no route to peer 8");
  one_line(standard_error("hosts --connect 127.0.0.1:1"), "127.0.0.1:1: Connection refused");
  const auto other = standard_error("hosts --network other" + quick);
  CHECK(other.status == 1);
  CHECK(other.out.find("not as a peer of the network `other`") != std::string::npos);
}
