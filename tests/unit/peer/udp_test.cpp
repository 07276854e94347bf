// Two peers that programs drive, over UDP on loopback: alone, and through a relay that loses.
#include <map>

#include "core/numbers/random.hpp"
#include "io/udp/udp_socket.hpp"
#include "unit/peer/fixture.hpp"

namespace rubicon::peer {
namespace {

standalone_config udp_config_of(std::int32_t id) {
  auto x = test::config_of(id);
  x.links.udp = true;
  return x;
}

std::string udp_url(std::uint16_t port) {
  return "udp://127.0.0.1:" + std::to_string(port);
}

/// Stands between a port and one who asks for sessions there; drops what the dice say.
class lossy_relay {
public:
  lossy_relay(io::loop& loop, std::uint16_t to, double loss)
      : loss_(loss),
        front_(
            open(loop,
                 [this, to](byte_view x, std::size_t each, const auto& from, std::uint16_t port) {
                   asks_ = {from, port};
                   pass(back_, x, each, {127, 0, 0, 1}, to);
                 })),
        back_(open(loop, [this](byte_view x, std::size_t each, const auto&, std::uint16_t) {
          pass(front_, x, each, asks_.first, asks_.second);
        })) {}

  [[nodiscard]] std::uint16_t port() const { return front_.port(); }
  void set_loss(double loss) { loss_ = loss; }

  std::size_t passed = 0;
  std::size_t lost = 0;

private:
  template <class F>
  static io::udp_socket open(io::loop& loop, F f) {
    auto x = io::udp_socket::open(loop, "127.0.0.1", 0, {std::move(f), [] {}});
    REQUIRE(std::holds_alternative<io::udp_socket>(x));
    return std::get<io::udp_socket>(std::move(x));
  }

  void pass(io::udp_socket& over, byte_view x, std::size_t each, const ipv4_address& to,
            std::uint16_t port) {
    for (; !x.empty(); x = x.subspan(std::min(each, x.size()))) {
      if (dice_.chance(loss_)) {
        ++lost;
        continue;
      }
      const auto one = x.first(std::min(each, x.size()));
      ++passed;
      over.send(to_bytes(one), one.size(), to, port);
    }
  }

  double loss_;
  random_stream dice_{1};
  std::pair<ipv4_address, std::uint16_t> asks_;
  io::udp_socket front_;
  io::udp_socket back_;
};

struct udp_peers {
  io::loop loop;
  std::unique_ptr<standalone> a = test::open(loop, udp_config_of(1));
  std::optional<lossy_relay> relay;
  std::unique_ptr<standalone> b;

  explicit udp_peers(std::optional<double> loss = std::nullopt) {
    auto port = a->links().udp_port().value();
    if (loss)
      port = relay.emplace(loop, port, *loss).port();
    auto config = udp_config_of(2);
    config.kernel.network.connections.always = {udp_url(port)};
    b = test::open(loop, config);
    REQUIRE(run([&] {
      return a->network().hosts.records().size() == 2 && b->network().hosts.records().size() == 2;
    }));
  }
  bool run(const std::function<bool()>& done) { return test::run({a.get(), b.get()}, done); }
};

} // namespace

TEST_CASE("links over UDP are off unless asked for", "[peer][UDP-01]") {
  io::loop loop;
  auto config = test::config_of(1);
  CHECK_FALSE(config.links.udp);
  std::vector<std::string> warnings;
  config.on_warning = [&](const std::string& text) { warnings.push_back(text); };
  config.kernel.network.connections.always = {"udp://127.0.0.1:9"};
  const auto x = test::open(loop, config);
  CHECK(!x->links().udp_port());
  REQUIRE(x->links().addresses().size() == 1);
  CHECK(x->run_until([&] { return !warnings.empty(); }, test::patience));
  CHECK(warnings.front() == "udp://127.0.0.1:9: links over UDP are disabled");
  const auto y = test::open(loop, udp_config_of(2));
  REQUIRE(y->links().addresses().size() == 2);
  CHECK(to_string(peis::url_of(y->links().addresses()[1])) ==
        udp_url(y->links().udp_port().value()));
  CHECK(y->links().udp_port() == y->links().port()); // the same number, where it is free
}

TEST_CASE("two kernels over UDP set, subscribe, ask and send as over TCP",
          "[peer][UDP-01][LNK-01][TUP-04][TUP-05]") {
  udp_peers p;
  REQUIRE(p.b->links().over_udp()->open_links() == 1);
  REQUIRE(p.b->links().open_links() == 1);
  std::vector<std::string> seen;
  const auto watch = p.b->tuples().subscribe(
      peer_id{1}, "room.*", [&](const auto& x) { seen.emplace_back(x->text()); },
      [&](const auto&) { seen.emplace_back("gone"); });
  REQUIRE(std::holds_alternative<peis::subscription_id>(watch));
  REQUIRE(p.a->tuples().set("room.lamp", peis::text_content("on")) == peis::cause::none);
  CHECK(p.run([&] { return seen.size() == 1; }));
  std::optional<peis::cause> ended;
  p.b->tuples().set_remote(peer_id{1}, "room.lamp", peis::text_content("off"),
                           [&](const peis::outcome& x) { ended = x.why; });
  CHECK(p.run([&] { return seen.size() == 2 && ended.has_value(); }));
  CHECK(ended == peis::cause::none);
  REQUIRE(p.a->tuples().remove("room.lamp") == peis::cause::none);
  CHECK(p.run([&] { return seen.size() == 3; }));
  CHECK(seen == std::vector<std::string>{"on", "off", "gone"});
  const auto route = p.b->messages().trace(peer_id{1}, test::patience);
  REQUIRE(route);
  CHECK(route->size() == 3);
}

TEST_CASE("large values flow over UDP through bounded queues", "[peer][UDP-01][TUP-21]") {
  udp_peers p;
  std::size_t size = 0;
  const auto watch =
      p.b->tuples().subscribe(peer_id{1}, "scan", [&](const auto& x) { size = x->value.size(); });
  REQUIRE(std::holds_alternative<peis::subscription_id>(watch));
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
  const auto counted = p.a->links().over_udp()->counters();
  CHECK(counted.malformed + counted.unknown + counted.impossible + counted.unsent == 0);
}

TEST_CASE("what a network loses is sent again, and each value comes once in order",
          "[peer][UDP-01][UDP-02]") {
  udp_peers p(0.05);
  std::vector<std::string> seen;
  const auto watch = p.b->tuples().subscribe(peer_id{1}, "count",
                                             [&](const auto& x) { seen.emplace_back(x->text()); });
  REQUIRE(std::holds_alternative<peis::subscription_id>(watch));
  REQUIRE(p.run([&] { return p.a->kernel().reader().has_subscriber("count"); }));
  const std::string filler(500, '.');
  std::vector<std::string> set;
  while (set.size() < 500) {
    if (!p.a->kernel().reader().is_waiting("count")) {
      set.push_back(std::to_string(set.size()) + filler);
      REQUIRE(p.a->tuples().set("count", peis::text_content(set.back())) == peis::cause::none);
    }
    p.a->step(0ms);
    p.b->step(0ms);
  }
  CHECK(p.run([&] { return seen.size() == set.size(); }));
  CHECK(seen == set);
  CHECK(p.relay->lost > 0);
  CHECK(p.a->links().over_udp()->counters().parts_resent > 0);
}

TEST_CASE("a link over UDP ends with its peer, and comes back with it", "[peer][UDP-01][KH-04]") {
  udp_peers p;
  std::vector<bool> changes;
  p.a->on_host_change([&](peer_id, bool is_there) { changes.push_back(is_there); });
  const auto port = p.a->links().udp_port().value();
  SECTION("it leaves") {
    p.b->leave();
    CHECK(p.b->links().open_links() == 0);
    CHECK(p.b->links().closing_links() == 0);
  }
  SECTION("its process is gone") {
    p.b.reset();
  }
  CHECK(p.a->run_until([&] { return changes == std::vector{false}; }, test::patience));
  CHECK(p.a->links().open_links() == 0);
  auto again = udp_config_of(2);
  again.kernel.network.connections.always = {udp_url(port)};
  again.seed = 77; // another magic number
  p.b = test::open(p.loop, again);
  CHECK(p.run([&] { return changes == std::vector{false, true}; }));
}

TEST_CASE("a route over UDP that is cut is noticed, and used again when it is mended",
          "[peer][UDP-01][KH-05]") {
  udp_peers p(0.0);
  p.relay->set_loss(1);
  CHECK(p.run([&] {
    return !p.a->network().reachable(peer_id{2}) && !p.b->network().reachable(peer_id{1});
  }));
  p.relay->set_loss(0);
  CHECK(p.run([&] {
    return p.a->network().reachable(peer_id{2}) && p.b->network().reachable(peer_id{1});
  }));
}

TEST_CASE("hostile datagrams are counted and change nothing", "[peer][UDP-01]") {
  udp_peers p;
  auto opened = io::udp_socket::open(p.loop, "127.0.0.1", 0, {[](auto&&...) {}, [] {}});
  auto& hostile = std::get<io::udp_socket>(opened);
  const auto port = p.a->links().udp_port().value();
  const auto send = [&](bytes x) {
    const auto size = std::max<std::size_t>(1, x.size());
    hostile.send(std::move(x), size, {127, 0, 0, 1}, port);
  };
  send(to_bytes("GET / HTTP/1.0"));
  send(bytes(30'000, 'x'));
  send(bytes(1400, 0));
  send(encode(peis::udp_handshake{peis::udp_handshake::step::open, 1, {2}, 3}));
  send(encode(peis::udp_handshake{peis::udp_handshake::step::gone, 1, {2}, 3}));
  CHECK(p.run([&] {
    const auto x = p.a->links().over_udp()->counters();
    return x.malformed == 3 && x.bad_cookies == 1 && x.unknown == 1;
  }));
  CHECK(p.a->links().open_links() == 1);
}

} // namespace rubicon::peer
