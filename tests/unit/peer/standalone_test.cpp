// Two peers that programs drive, over loopback TCP.
#include "unit/peer/fixture.hpp"

namespace rubicon::peer {
namespace {

struct standalone_peers {
  io::loop loop;
  std::vector<std::string> warnings;
  std::unique_ptr<standalone> a;
  std::unique_ptr<standalone> b;

  standalone_peers() {
    a = test::open(loop, test::config_of(1));
    b = test::open(loop, joining(2));
    REQUIRE(run([&] {
      return a->network().hosts.records().size() == 2 && b->network().hosts.records().size() == 2;
    }));
  }

  standalone_config joining(std::int32_t id) {
    auto x = test::config_of(id);
    x.kernel.network.connections.always = {test::url_of(*a)};
    x.on_warning = [this](const std::string& text) { warnings.push_back(text); };
    return x;
  }
  bool run(const std::function<bool()>& done) { return test::run({a.get(), b.get()}, done); }
  std::optional<peis::cause> await(const std::function<void(outcome_callback)>& begin) {
    std::optional<peis::cause> ended;
    int times = 0;
    begin([&](const peis::outcome& x) {
      ended = x.why;
      ++times;
    });
    run([&] { return ended.has_value(); });
    CHECK(times == 1);
    return ended;
  }
};

bool is_watch(const watch_result& x) {
  return std::holds_alternative<peis::subscription_id>(x);
}

} // namespace

TEST_CASE("tuples pass between two peers in every form", "[peer][TUP-04][TUP-05][TUP-07]") {
  standalone_peers p;
  std::vector<std::string> seen;
  REQUIRE(is_watch(p.b->tuples().subscribe(
      peer_id{1}, "room.*", [&](const auto& x) { seen.emplace_back(x->text()); },
      [&](const auto&) { seen.emplace_back("gone"); })));
  REQUIRE(p.a->tuples().set("room.lamp", peis::text_content("on")) == peis::cause::none);
  CHECK(p.run([&] { return seen.size() == 1; }));
  CHECK(p.await([&](auto then) {
    p.b->tuples().set_remote(peer_id{1}, "room.lamp", peis::text_content("off"), then);
  }) == peis::cause::none);
  CHECK(p.run([&] { return seen.size() == 2; }));
  CHECK(p.await([&](auto then) {
    p.b->tuples().append(peis::prototype_of(peer_id{1}, *peis::key::parse("room.lamp")),
                         to_bytes("!"), then);
  }) == peis::cause::none);
  CHECK(p.run([&] { return seen.size() == 3; }));
  CHECK(p.await([&](auto then) { p.b->tuples().remove_remote(peer_id{1}, "room.lamp", then); }) ==
        peis::cause::none);
  CHECK(p.run([&] { return seen.size() == 4; }));
  CHECK(seen == std::vector<std::string>{"on", "off", "off!", "gone"});
  CHECK(p.a->tuples().get(peer_id{1}, "room.lamp").content == nullptr);
}

TEST_CASE("a tuple is set with all its fields", "[peer][TUP-06]") {
  standalone_peers p;
  peis::tuple draft;
  draft.owner = peer_id{1};
  draft.name = *peis::key::parse("a.b");
  draft.value = to_bytes(std::string("x\0", 2));
  draft.user_time = {5, 6};
  CHECK(p.await([&](auto then) { p.a->tuples().insert(draft, then); }) == peis::cause::none);
  CHECK(p.a->tuples().get(peer_id{1}, "a.b").content->user_time == peis::timestamp{5, 6});
  draft.owner = any_peer;
  CHECK(p.a->tuples().insert(draft) == peis::cause::abstract);
}

TEST_CASE("a blocking read ends when the tuple comes, or with its time", "[peer][TUP-12]") {
  standalone_peers p;
  using peis::read_mode;
  CHECK(!p.b->tuples().get(peer_id{1}, "slow", read_mode::keep_old, 30ms));
  CHECK(p.b->tuples().get(any_peer, "slow", read_mode::keep_old, 1h).why == peis::cause::abstract);
  REQUIRE(is_watch(p.b->tuples().subscribe(peer_id{1}, "slow")));
  REQUIRE(p.a->tuples().set("slow", peis::text_content("there")) == peis::cause::none);
  const auto found = p.b->tuples().get(peer_id{1}, "slow", read_mode::filter_old, test::patience);
  REQUIRE(found);
  CHECK(found.content->text() == "there");
  CHECK(!p.b->tuples().get(peer_id{1}, "slow", read_mode::filter_old, 30ms)); // read already
  peis::result_set all;
  p.b->tuples().get_all(peis::prototype_of(any_peer, *peis::key::parse("slow")), all);
  p.b->tuples().get_all(peis::prototype_of(peer_id{2}, *peis::key::parse("kernel.id")), all);
  CHECK(all.size() == 2);
}

TEST_CASE("messages reach all hooks of a port in their order", "[peer][API-02][API-05][API-07]") {
  standalone_peers p;
  std::vector<std::string> received;
  CHECK(p.a->messages().register_hook(
      30, [&](const auto& x) { received.push_back("1" + to_string(x.octets.view())); }));
  CHECK(p.a->messages().register_hook(
      30, [&](const auto& x) { received.push_back("2" + to_string(x.octets.view())); }));
  CHECK(!p.a->messages().register_hook(19, [](const auto&) {}));
  CHECK(p.await([&](auto then) {
    p.b->messages().send(30, peer_id{1}, to_bytes("x"), true, peis::priority::high, then);
  }) == peis::cause::none);
  CHECK(p.run([&] { return received.size() == 2; }));
  CHECK(p.b->messages().broadcast(30, to_bytes("y")) == peis::cause::none);
  CHECK(p.run([&] { return received.size() == 4; }));
  CHECK(received == std::vector<std::string>{"1x", "2x", "1y", "2y"});
  CHECK(p.b->messages().send(30, peer_id{77}, to_bytes("x"), true) == peis::cause::no_route);
  CHECK(p.b->messages().broadcast(30, bytes(1025)) == peis::cause::too_long);
}

TEST_CASE("callbacks may call, wait and watch", "[peer][CB-03][CB-04]") {
  standalone_peers p;
  std::optional<peis::subscription_id> mine;
  bool answered = false;
  const auto watch = p.b->tuples().subscribe(peer_id{1}, "question", [&](const auto&) {
    CHECK(p.b->tuples().set("answer", peis::text_content("42")) == peis::cause::none);
    CHECK(!p.b->await(20ms, [&](auto then) { // peer 1 is not stepped meanwhile
      p.b->tuples().set_remote(peer_id{1}, "seen", peis::text_content("yes"), then);
    }));
    p.b->tuples().unsubscribe(*mine);
    answered = true;
  });
  REQUIRE(is_watch(watch));
  mine = std::get<peis::subscription_id>(watch);
  REQUIRE(p.a->tuples().set("question", peis::text_content("?")) == peis::cause::none);
  CHECK(p.run([&] { return answered; }));
  CHECK(p.b->tuples().get(peer_id{2}, "answer").content->text() == "42");
  CHECK(p.run([&] { return p.a->tuples().get(peer_id{1}, "seen").content != nullptr; }));
}

TEST_CASE("a route is traced", "[peer][API-12]") {
  standalone_peers p;
  const auto route =
      p.b->messages().trace(peer_id{1}, test::patience); // the other answers on the same loop
  REQUIRE(route);
  CHECK(*route == std::vector<peer_id>{peer_id{2}, peer_id{1}, peer_id{2}});
}

TEST_CASE("who leaves is forgotten at once and may come back", "[peer][KH-04]") {
  standalone_peers p;
  std::vector<bool> changes;
  p.a->on_host_change([&](peer_id, bool is_there) { changes.push_back(is_there); });
  p.b->leave();
  CHECK(p.a->run_until([&] { return changes == std::vector{false}; }, test::patience));
  CHECK(p.b->links().open_links() == 0);
  CHECK(p.b->tuples().set("x", peis::text_content("y")) == peis::cause::left);
  auto again = p.joining(2);
  again.seed = 77; // another magic number
  p.b = test::open(p.loop, again);
  CHECK(p.run([&] { return changes == std::vector{false, true}; }));
}

TEST_CASE("large values flow through bounded queues", "[peer][TUP-21]") {
  standalone_peers p;
  std::size_t size = 0;
  REQUIRE(is_watch(
      p.b->tuples().subscribe(peer_id{1}, "scan", [&](const auto& x) { size = x->value.size(); })));
  bytes big(10'000'000);
  for (std::size_t i = 0; i < big.size(); ++i)
    big[i] = static_cast<std::uint8_t>(i % 253);
  REQUIRE(p.a->tuples().set("scan", peis::binary_content(big)) == peis::cause::none);
  std::size_t most = 0;
  CHECK(p.run([&] {
    most = std::max(most, p.a->links().unsent());
    return size == big.size();
  }));
  CHECK(p.b->tuples().get(peer_id{1}, "scan").content->value == payload(big));
  CHECK(most <= tcp_links::window + peis::header_size + peis::data_max);
}

TEST_CASE("no stranger is let near the network unasked", "[peer]") {
  io::loop loop;
  const auto x = test::open(loop, test::config_of(1));
  const auto addresses = x->links().addresses();
  REQUIRE(addresses.size() == 1);
  CHECK(addresses[0].loopback);
  CHECK(to_string(peis::url_of(addresses[0])) == test::url_of(*x));
  auto config = test::config_of(2);
  config.links.first_port.reset();
  const auto y = test::open(loop, config);
  CHECK(!y->links().port());
  CHECK(y->links().addresses().empty());
}

TEST_CASE("an address that cannot be listened on is refused", "[peer]") {
  io::loop loop;
  auto config = test::config_of(1);
  config.links.listen_address = "192.0.2.1";
  const auto x = standalone::open(loop, config);
  REQUIRE(std::holds_alternative<std::string>(x));
  CHECK(std::get<std::string>(x).starts_with("cannot listen on 192.0.2.1:0: "));
}

TEST_CASE("attempts that fail are reported, whatever the medium", "[peer][LNK-05][LNK-07]") {
  io::loop loop;
  auto config = test::config_of(1);
  std::vector<std::string> warnings;
  config.on_warning = [&](const std::string& text) { warnings.push_back(text); };
  config.kernel.network.connections.always = {"bt://AA:BB:CC:DD:EE:FF"};
  const auto x = test::open(loop, config);
  CHECK(x->run_until([&] { return !warnings.empty(); }, test::patience));
  CHECK(warnings.front() == "bt://AA:BB:CC:DD:EE:FF: not an address of TCP or UDP");
}

TEST_CASE("work of a period is done when it is due, of period zero in each step",
          "[peer][SCH-01][SCH-02][SCH-03]") {
  io::loop loop;
  const auto x = test::open(loop, test::config_of(1));
  unsigned each_step = 0;
  std::vector<instant> due;
  const auto begin = x->now();
  x->run_every(0s, [&] { ++each_step; });
  x->run_every(20ms, [&] { due.push_back(x->now()); });
  unsigned steps = 0;
  while (due.size() < 3) {
    x->step(1s);
    ++steps;
  }
  CHECK(each_step == steps);
  while (x->now() - due.back() < 5 * 20ms) { // four of them are missed, and not made up for
  }
  const auto stalled = x->now();
  x->step(0ms);
  x->step(0ms);
  REQUIRE(due.size() == 4);
  while (due.size() < 5)
    x->step(1s);
  CHECK(due[4] > stalled);
  for (std::size_t i = 0; i < due.size(); ++i)
    CHECK(due[i] - begin >= (i + 1) * 20ms);
}

TEST_CASE("steps that come too rarely are reported", "[peer][SCH-05]") {
  io::loop loop;
  auto config = test::config_of(1);
  std::vector<std::string> warnings;
  config.on_warning = [&](const std::string& text) { warnings.push_back(text); };
  const auto x = test::open(loop, config);
  x->step(0ms);
  x->step(0ms);
  const auto begin = x->now();
  while (x->now() - begin < 2 * standalone::step_gap_max) {
  }
  x->step(0ms);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].ends_with("it needs a step every 50 ms at least"));
}

} // namespace rubicon::peer
