// A peer on a real TCP port, spoken to in octets that a real kernel has sent (tests/golden/peis):
// peer 20 joins peer 10 of the network `default`.
#include "unit/peer/fixture.hpp"

namespace rubicon::peer {
namespace {

using test::raw_peer;

struct visited {
  io::loop loop;
  std::unique_ptr<standalone> peer = test::open(loop, test::config_of(10));

  [[nodiscard]] bool until(const std::function<bool()>& done) const {
    return peer->run_until(done, test::patience);
  }
  [[nodiscard]] bool knows(std::int32_t id) const {
    const auto hosts = peer->network().hosts.records();
    return std::any_of(hosts.begin(), hosts.end(),
                       [&](const auto* x) { return x->id == peer_id{id}; });
  }
  std::unique_ptr<raw_peer> connect() const {
    auto x = std::make_unique<raw_peer>(const_cast<io::loop&>(loop), *peer);
    REQUIRE(until([&] { return x->open(); }));
    return x;
  }
  /// Peer 20, as far as it has described itself.
  std::unique_ptr<raw_peer> join() const {
    auto x = connect();
    x->say("connect-from-real");
    x->say("hostinfo-link");
    REQUIRE(until([&] { return knows(20); }));
    return x;
  }
};

} // namespace

TEST_CASE("a real kernel's connect request is answered with record and routes",
          "[peer][LNK-06][interop]") {
  visited v;
  const auto x = v.join();
  REQUIRE(v.until([&] { return x->last(13) && x->last(0); }));
  const auto all = x->packages();
  CHECK(all[0].port() == 13); // before anything else (docs/peis-wire.md 3.3)
  CHECK(all[0].source() == 10);
  CHECK(all[0].word(40) == 10);
  CHECK(all[0].text(48) == "host10");
  CHECK(all[0].octets.size() == 40 + 552);
  CHECK(x->last(0)->source() == 10);
  CHECK(v.peer->network().reachable(peer_id{20}));
}

TEST_CASE("the octets may come one by one", "[peer][TCP-05][interop]") {
  visited v;
  const auto x = v.connect();
  auto all = rubicon::test::read_hex_file("peis/connect-from-real.hex");
  const auto record = rubicon::test::read_hex_file("peis/hostinfo-link.hex");
  all.insert(all.end(), record.begin(), record.end());
  for (const auto octet : all) {
    x->send(bytes{octet});
    v.peer->step(0ms);
  }
  CHECK(v.until([&] { return v.knows(20); }));
}

TEST_CASE("a real kernel sets, subscribes, appends and unsubscribes",
          "[peer][TUP-05][GEN-12][interop]") {
  visited v;
  const auto x = v.join();
  x->say("set-remote");
  REQUIRE(v.until([&] { return v.peer->tuples().get(peer_id{10}, "bar").content != nullptr; }));
  const auto bar = v.peer->tuples().get(peer_id{10}, "bar").content;
  CHECK(bar->text() == "remote value");
  CHECK(bar->creator == peer_id{20});
  CHECK(v.until([&] { return x->has_acknowledged(1938552350); })); // the set's ackID

  REQUIRE(v.peer->tuples().set("foo", peis::text_content("hello")) == peis::cause::none);
  x->say("subscribe-exact");
  REQUIRE(v.until([&] { return x->last(7).has_value(); })); // what is there comes at once
  CHECK(x->last(7)->text(124) == "foo");
  CHECK(v.peer->kernel().reader().has_subscriber("foo"));
  CHECK(x->last(7)->source() == 10);
  x->say("append-request");
  const auto foo = [&] { return v.peer->tuples().get(peer_id{10}, "foo").content; };
  REQUIRE(v.until([&] { return foo()->text() == "helloremotely"; }));
  CHECK(v.until([&] { return x->has_acknowledged(518484346); })); // the request's ackID
  x->say("unsubscribe-exact");
  CHECK(v.until([&] { return !v.peer->kernel().reader().has_subscriber("foo"); }));
}

TEST_CASE("a long value of a real kernel arrives whole", "[peer][P2P-05][interop]") {
  io::loop loop;
  const auto peer = test::open(loop, test::config_of(20));
  auto x = raw_peer(loop, *peer);
  REQUIRE(peer->run_until([&] { return x.open(); }, test::patience));
  auto request = rubicon::test::read_hex_file("peis/connect-from-real.hex");
  request[7] = 10; // peer 10 joins
  x.send(request);
  std::size_t size = 0;
  const auto watch = peer->tuples().subscribe(any_peer, "", [&](const auto& y) {
    size = y->owner == peer_id{10} ? y->value.size() : size;
  });
  REQUIRE(std::holds_alternative<peis::subscription_id>(watch));
  x.say("push-fragments");
  CHECK(peer->run_until([&] { return size == 3000; }, test::patience));
}

TEST_CASE("an exit notice ends link and host, and the next incarnation is welcome",
          "[peer][KH-04][interop]") {
  visited v;
  std::vector<std::pair<std::int32_t, bool>> changes;
  v.peer->on_host_change(
      [&](peer_id id, bool is_there) { changes.emplace_back(id.value, is_there); });
  const auto x = v.join();
  x->say("dead-host-exit");
  CHECK(v.until([&] { return x->closed() && !v.knows(20); }));
  const auto y = v.connect();
  auto record = rubicon::test::read_hex_file("peis/hostinfo-link.hex");
  record[44] ^= 1;            // of its magic number
  record[7] = record[15] = 1; // and a package of its own
  y->say("connect-from-real");
  y->send(record);
  CHECK(v.until([&] { return v.knows(20); }));
  CHECK(changes == decltype(changes){{20, true}, {20, false}, {20, true}});
}

TEST_CASE("what is no peer of ours is refused, and the others are served", "[peer][TCP-06]") {
  visited v;
  const auto good = v.join();
  const auto bad = v.connect();
  auto request = rubicon::test::read_hex_file("peis/connect-from-real.hex");
  request[7] = 21;
  bool closes = true;
  SECTION("another version") {
    request[3] = 0xf3;
    bad->send(request);
  }
  SECTION("another network") {
    request[12] = 'D';
    bad->send(request);
  }
  SECTION("our own id") {
    request[7] = 10;
    bad->send(request);
  }
  SECTION("a network string without end") {
    std::fill(request.begin() + 12, request.end(), 'x');
    bad->send(request);
  }
  SECTION("garbage instead of a request") {
    bad->send(bytes(500, 0xa5));
  }
  SECTION("garbage instead of a package") {
    bad->send(request);
    bad->send(bytes(500, 0xa5));
  }
  SECTION("half a package") {
    auto half = rubicon::test::read_hex_file("peis/set-remote.hex");
    half.resize(half.size() - 5);
    bad->send(request);
    bad->send(half);
    closes = false;
  }
  SECTION("an end in the middle of a request") {
    request.resize(50);
    bad->send(request);
    for (int i = 0; i < 3; ++i)
      v.peer->step(0ms);
    bad->drop();
    closes = false;
  }
  if (closes)
    CHECK(v.until([&] { return bad->closed(); }));
  good->say("set-remote");
  CHECK(v.until([&] { return v.peer->tuples().get(peer_id{10}, "bar").content != nullptr; }));
  CHECK(!good->closed());
}

TEST_CASE("beyond 64 links the next ones are refused, and the others are served",
          "[peer][LNK-06][TCP-04]") {
  visited v;
  const auto request = rubicon::test::read_hex_file("peis/connect-from-real.hex");
  std::vector<std::unique_ptr<raw_peer>> crowd;
  crowd.push_back(v.join());
  for (std::uint8_t i = 0; i < 80; ++i) {
    crowd.push_back(v.connect());
    auto mine = request;
    mine[7] = static_cast<std::uint8_t>(100 + i);
    crowd.back()->send(mine);
  }
  const auto refused = [&] {
    return std::count_if(crowd.begin(), crowd.end(), [](const auto& x) { return x->closed(); });
  };
  CHECK(v.until([&] { return refused() == 81 - 64; }));
  CHECK(v.peer->links().open_links() == 64);
  crowd.front()->say("set-remote");
  CHECK(v.until([&] { return v.peer->tuples().get(peer_id{10}, "bar").content != nullptr; }));
  CHECK(refused() == 81 - 64);
}

} // namespace rubicon::peer
