// Packages that pass through a peer, and hooks that may stop them (API-06).
#include <algorithm>
#include <vector>

#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis::test {
namespace {

constexpr std::uint16_t port = 30;
constexpr peer_id first{1};
constexpr peer_id second{2};
constexpr peer_id third{3};
constexpr peer_id last{4};

/// Three hops.
class hooked_line {
public:
  hooked_line() {
    w.add_line(4);
    w.run_for(5s);
    for (const auto id : w.peers())
      REQUIRE(w.at(id).messages().hook_port(port));
  }

  /// The second peer's hook: consumes what `stops` asks for.
  void hook(std::function<bool(const package_header&)> stops) {
    REQUIRE(w.at(second).messages().hook_transit(
        port, [this, stops](const auto& header, byte_view data) {
          shown.push_back(to_bytes(data));
          return stops(header) ? verdict::consume : verdict::ignore;
        }));
  }

  void send(peer_id from, peer_id to, bytes octets, bool reliable) {
    w.perform(from, w.at(from).messages().send(to, port, std::move(octets), reliable,
                                               priority::normal, request_id{++requests}, w.now()));
  }

  world w;
  std::vector<bytes> shown;
  std::uint64_t requests = 0;
};

const auto everything = [](const package_header&) { return true; };
const auto nothing = [](const package_header&) { return false; };

} // namespace

TEST_CASE("a hook in the middle of a line sees what passes and lets it pass", "[peis][API-06]") {
  hooked_line line;
  line.hook(nothing);
  line.send(first, last, {1, 2}, true);
  line.send(last, first, {3}, false);
  line.w.run_for(1s);
  CHECK(line.shown == std::vector<bytes>{{1, 2}, {3}});
  REQUIRE(line.w.all<message>(last).size() == 1);
  CHECK(line.w.all<message>(first).size() == 1);
  CHECK(line.w.all<outcome>(first).at(0).success);
  CHECK(line.w.all<intercepted>(second).empty());
}

TEST_CASE("what a hook on the way consumes is not delivered, and that is told", "[peis][API-06]") {
  hooked_line line;
  line.hook([](const auto& header) { return header.source == first; });
  line.send(first, last, {1}, false);
  line.send(last, first, {2}, false);
  line.send(first, second, {3}, false); // for the middle peer itself: passes nothing
  line.w.run_for(1s);
  CHECK(line.w.all<message>(last).empty());
  CHECK(line.w.all<message>(first).size() == 1);
  CHECK(line.w.all<message>(second).size() == 1);
  CHECK(line.shown.size() == 2);
  const auto told = line.w.all<intercepted>(second);
  REQUIRE(told.size() == 1);
  CHECK(told[0].port == port);
  CHECK(told[0].source == first);
  CHECK(told[0].destination == last);
  CHECK(line.w.at(second).counters().network.intercepted == 1);
}

TEST_CASE("a reliable message that is consumed on its way fails at its sender", "[peis][API-06]") {
  hooked_line line;
  line.hook(everything);
  line.send(first, last, {1}, true);
  line.w.run_for(60s);
  CHECK(line.w.all<message>(last).empty());
  REQUIRE(line.w.all<outcome>(first).size() == 1);
  CHECK(!line.w.all<outcome>(first)[0].success);
  CHECK(line.w.at(second).counters().network.intercepted > 1); // each repeat of it
}

TEST_CASE("a consumed broadcast reaches the hook's own host and nobody beyond", "[peis][API-06]") {
  hooked_line line;
  line.hook(everything);
  line.w.perform(first,
                 line.w.at(first).messages().broadcast(port, bytes{1}, no_request, line.w.now()));
  line.w.run_for(1s);
  CHECK(line.w.all<message>(second).size() == 1);
  CHECK(line.w.all<message>(third).empty());
  CHECK(line.w.all<message>(last).empty());
  REQUIRE(line.w.all<intercepted>(second).size() == 1);
  CHECK(line.w.all<intercepted>(second)[0].destination == any_peer);
}

TEST_CASE("a message of several packages is seen at its destination only", "[peis][API-06]") {
  hooked_line line;
  line.hook(everything);
  line.send(first, last, bytes(5000, 7), true);
  line.w.run_for(5s);
  CHECK(line.shown.empty());
  REQUIRE(line.w.all<message>(last).size() == 1);
  CHECK(line.w.all<message>(last)[0].octets.size() == 5000);
}

TEST_CASE("a hook that is taken away sees nothing more, and ports of services take none",
          "[peis][API-06][API-09]") {
  hooked_line line;
  line.hook(everything);
  REQUIRE(line.w.at(second).messages().hook_transit(port, {}));
  line.send(first, last, {1}, true);
  line.w.run_for(1s);
  CHECK(line.shown.empty());
  CHECK(line.w.all<message>(last).size() == 1);
  for (const auto illegal : std::initializer_list<std::uint16_t>{0, 4, 19, 50, 65535})
    CHECK(!line.w.at(second).messages().hook_transit(
        illegal, [](const auto&, byte_view) { return verdict::consume; }));
}

} // namespace rubicon::peis::test
