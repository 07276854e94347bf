// Messages, links and queues between two or three kernels.
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis {
namespace {

using test::world;

bytes pattern(std::size_t size) {
  bytes octets(size);
  for (std::size_t i = 0; i < size; ++i)
    octets[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
  return octets;
}

close_cause why_closed(const bytes& octets) {
  world w;
  const auto a = w.add(1);
  auto& kernel = w.at(a);
  w.perform(a, kernel.on_link_open(link_id{9}, link_role::acceptor, w.now()));
  w.perform(a, kernel.on_link_octets(link_id{9}, octets, w.now()));
  const auto closed = w.all<close_link>(a);
  REQUIRE(closed.size() == 1);
  return closed[0].why;
}

} // namespace

TEST_CASE("a connect request that must be refused closes the link", "[peis][LNK-06]") {
  CHECK(why_closed(encode(connect_request{500, peer_id{2}, 0, "other"})) ==
        close_cause::wrong_network);
  CHECK(why_closed(encode(connect_request{501, peer_id{2}, 0, "test"})) ==
        close_cause::wrong_version);
  CHECK(why_closed(encode(connect_request{500, peer_id{1}, 0, "test"})) == close_cause::own_id);
  CHECK(why_closed(encode(connect_request{500, peer_id{0}, 0, "test"})) == close_cause::bad_id);
}

TEST_CASE("peers of different networks never exchange a tuple", "[peis][LNK-06]") {
  world w;
  const auto a = w.add(1);
  auto other = test::config_of(2);
  other.network.network = "elsewhere";
  const auto b = w.add(other);
  w.perform(b, w.at(b).subscriptions().subscribe(any_peer, "", subscription_id{1}, w.now()));
  w.clear_logs();
  w.connect(a, b);
  w.run_for(20s);
  for (const auto& x : w.all<tuple_changed>(b))
    CHECK(x.content->owner == b);
  CHECK(w.all<close_link>(b).size() == 1);
  CHECK(!w.at(a).network().reachable(b));
  CHECK(!w.at(b).network().reachable(a));
}

TEST_CASE("a silent connecter is cut off, as is a link that falls silent", "[peis][LNK-07]") {
  world w;
  const auto a = w.add(1);
  w.perform(a, w.at(a).on_link_open(link_id{9}, link_role::acceptor, w.now()));
  w.run_for(4999ms);
  CHECK(w.all<close_link>(a).empty());
  w.run_for(2ms);
  REQUIRE(w.all<close_link>(a).size() == 1);
  CHECK(w.all<close_link>(a)[0].why == close_cause::handshake_silent);

  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(25s);
  CHECK(w.at(a).network().reachable(b));
  w.keep = [](const package_header&) { return false; };
  w.run_for(41s);
  CHECK(w.all<close_link>(a).back().why == close_cause::silent);
  CHECK(!w.at(a).network().reachable(b));
}

TEST_CASE("a corrupted stream closes the link", "[peis][TCP-06]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  const auto link = w.connect(a, b);
  w.run_for(1s);
  w.perform(a, w.at(a).on_link_octets(link, bytes(40, 0x55), w.now()));
  REQUIRE(w.all<close_link>(a).size() == 1);
  CHECK(w.all<close_link>(a)[0].why == close_cause::bad_stream);
  CHECK(w.at(a).counters().network.links_broken == 1);
  w.run_for(10ms);
  CHECK(!w.at(b).network().reachable(a));
}

TEST_CASE("messages arrive whole whatever their size", "[peis][API-02][P2P-05]") {
  const auto size = GENERATE(0U, 1U, 1023U, 1024U, 1025U, 300'000U, 10U << 20U);
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  w.at(b).messages().hook_port(30);
  const auto octets = pattern(size);
  w.perform(a,
            w.at(a).messages().send(b, 30, octets, true, priority::normal, request_id{5}, w.now()));
  w.run_for(30s);
  const auto got = w.all<message>(b);
  REQUIRE(got.size() == 1);
  CHECK(to_bytes(got[0].octets.view()) == octets);
  CHECK(got[0].source == a);
  const auto outcomes = w.all<outcome>(a);
  REQUIRE(outcomes.size() == 1);
  CHECK(outcomes[0].success);
  CHECK(outcomes[0].request == request_id{5});
}

TEST_CASE("a 300 kB message survives loss, and each fragment is taken once",
          "[peis][API-02][ACK-08]") {
  const auto seed = GENERATE(range(1, 6));
  world w(static_cast<std::uint64_t>(seed));
  const auto a = w.add(1);
  const auto relay = w.add(2);
  const auto b = w.add(3);
  w.connect(a, relay);
  w.connect(relay, b);
  w.run_for(2s);
  w.at(b).messages().hook_port(30);
  random_stream rng(static_cast<std::uint64_t>(seed));
  w.keep = [&](const package_header& x) {
    return x.type == package_type::link || !rng.chance(0.1);
  };
  const auto octets = pattern(300'000);
  w.perform(a,
            w.at(a).messages().send(b, 30, octets, true, priority::normal, request_id{5}, w.now()));
  w.run_for(60s);
  const auto got = w.all<message>(b);
  REQUIRE(got.size() == 1);
  CHECK(to_bytes(got[0].octets.view()) == octets);
  CHECK(w.all<outcome>(a).at(0).success);
  CHECK(w.at(a).counters().network.retransmissions > 0);
}

TEST_CASE("lost acknowledgements cause no second delivery", "[peis][ACK-08]") {
  world w(3);
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  w.at(b).messages().hook_port(30);
  random_stream rng(8);
  w.keep = [&](const package_header& x) {
    return x.port != port::acknowledgements || !rng.chance(0.5);
  };
  for (std::uint64_t i = 1; i <= 200; ++i) {
    w.perform(a, w.at(a).messages().send(b, 30, bytes{1}, true, priority::normal, request_id{i},
                                         w.now()));
    w.run_for(20ms);
  }
  w.run_for(20s);
  CHECK(w.all<message>(b).size() == 200);
  CHECK(w.all<outcome>(a).size() == 200);
  CHECK(w.at(b).counters().network.repeated > 0);
}

TEST_CASE("a black hole sees the retry series and the sender a failure", "[peis][ACK-02][ACK-05]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  w.keep = [](const package_header& x) { return x.port != 30; };
  w.packages.clear();
  const auto start = w.now();
  w.perform(a,
            w.at(a).messages().send(b, 30, bytes{1}, true, priority::high, request_id{1}, w.now()));
  w.run_for(11199ms);
  CHECK(w.all<outcome>(a).empty());
  w.run_for(2ms);
  REQUIRE(w.all<outcome>(a).size() == 1);
  CHECK(w.all<outcome>(a)[0].why == cause::too_many_retries);
  std::vector<int> units;
  for (const auto& x : w.packages) {
    if (x.header.port == 30)
      units.push_back(static_cast<int>((x.at - start) / 400ms));
  }
  CHECK(units == std::vector<int>{0, 1, 3, 6, 10, 15, 21});
}

TEST_CASE("a hundred messages in a burst cost at most three acknowledgement packages",
          "[peis][ACK-06]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  const auto before = w.at(b).counters().network;
  for (std::uint64_t i = 1; i <= 100; ++i)
    w.perform(a, w.at(a).messages().send(b, 30, bytes{1}, true, priority::normal, request_id{i},
                                         w.now()));
  w.run_for(13ms); // 1 ms there, 10 ms at most waiting, 1 ms back
  CHECK(w.at(b).counters().network.ack_packages_sent - before.ack_packages_sent <= 3);
  CHECK(w.at(b).counters().network.acks_sent - before.acks_sent <= 200); // each id twice
  CHECK(w.all<outcome>(a).size() == 100);
}

TEST_CASE("requests that cannot succeed fail at once", "[peis][API-02][API-08][API-09]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  auto& kernel = w.at(a);
  const auto fails = [&](outputs todo, cause why) {
    for (const auto& x : todo) {
      if (const auto* o = std::get_if<outcome>(&x))
        return !o->success && o->why == why;
    }
    return false;
  };
  const request_id r{1};
  CHECK(fails(kernel.messages().send(peer_id{99}, 30, {}, true, priority::normal, r, w.now()),
              cause::no_route));
  CHECK(fails(kernel.messages().send(b, 19, {}, true, priority::normal, r, w.now()),
              cause::bad_port));
  CHECK(fails(kernel.messages().send(b, 50, {}, true, priority::normal, r, w.now()),
              cause::bad_port));
  CHECK(fails(
      kernel.messages().send(b, 30, bytes((16U << 20U) + 1), true, priority::normal, r, w.now()),
      cause::too_long));
  CHECK(fails(kernel.messages().broadcast(30, bytes(1025), r, w.now()), cause::too_long));
  CHECK(fails(kernel.messages().broadcast(5, bytes(1), r, w.now()), cause::bad_port));
  CHECK(!kernel.messages().hook_port(19));
  CHECK(!kernel.messages().hook_port(50));
  CHECK(kernel.messages().hook_port(20));
  CHECK(kernel.messages().hook_port(49));
}

TEST_CASE("queues overflow with counters, and control still passes", "[peis][P2P-03][ACK-05]") {
  world w;
  auto config = test::config_of(1);
  config.network.link_window = 4096;
  const auto a = w.add(config);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  w.at(b).messages().hook_port(30);
  w.drains = false;
  std::uint64_t sent = 0;
  for (std::uint64_t i = 1; i <= 3000; ++i) {
    w.perform(a, w.at(a).messages().send(b, 30, bytes(500), false, priority::normal, request_id{i},
                                         w.now()));
  }
  std::uint64_t refused = 0;
  for (const auto& x : w.all<outcome>(a)) {
    sent += x.success ? 1 : 0;
    refused += x.why == cause::queue_full || x.why == cause::early_drop ? 1 : 0;
  }
  const auto counters = w.at(a).counters().network;
  CHECK(sent + refused == 3000); // counters add up to the offered load
  CHECK(refused == counters.queue_full + counters.early_drop);
  CHECK(counters.early_drop > 0);
  CHECK(sent > 512);
  CHECK(sent <= 1024 + 9);
  w.drains = true;
  w.perform(a, w.at(a).on_link_sent(link_id{1}, 1 << 20, w.now()));
  w.run_for(30s);
  CHECK(w.all<message>(b).size() == sent);
}

TEST_CASE("a normal message overtakes bulk, a high one overtakes both", "[peis][API-03]") {
  world w;
  auto config = test::config_of(1);
  config.network.link_window = 8192;
  const auto a = w.add(config);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  w.at(b).messages().hook_port(30);
  const auto send = [&](std::size_t size, priority service) {
    w.perform(a, w.at(a).messages().send(b, 30, bytes(size), true, service, no_request, w.now()));
  };
  send(200'000, priority::bulk);
  send(2, priority::normal);
  send(1, priority::high);
  w.run_for(10s);
  const auto got = w.all<message>(b);
  REQUIRE(got.size() == 3);
  CHECK(got[0].octets.size() == 1);
  CHECK(got[1].octets.size() == 2);
  CHECK(got[2].octets.size() == 200'000);
}

TEST_CASE("idle kernels wake rarely", "[peis][performance]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(60s);
  const auto before = w.wakeups(a);
  w.run_for(600s);
  CHECK(w.wakeups(a) - before <= 800); // heartbeats each second, routing each 10 s, the clock
}

} // namespace rubicon::peis
