#include <map>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "traffic/packet.hpp"
#include "traffic/program.hpp"

using namespace rubicon;
using namespace rubicon::traffic;

namespace {

using causes = std::map<std::string, std::uint64_t>;

const outcome acked{true, true, {}, 1};
const outcome no_ack{false, false, "no_ack", 4};
const outcome ack_lost{false, true, "no_ack", 4}; ///< the next hop has it all the same
const outcome refused{false, false, "queue_full", 0};

constexpr mote_id self{2};

mote_address address(mote_id x) {
  return {island_id{1}, x};
}

program make(const program_config& config) {
  return {config, address(self), random_stream(1)};
}

sender_config sender(mote_id to, arrivals pattern = arrivals::periodic) {
  sender_config x;
  x.to = to;
  x.pattern = pattern;
  x.every = 100ms;
  x.start = 0s;
  return x;
}

program sending(const sender_config& x) {
  return make({{x}, {}, false});
}

program relaying(mote_id next) {
  return make({{}, relay_config{next}, false});
}

program receiving() {
  return make({{}, {}, true});
}

bytes packet_of(std::uint16_t origin, mote_id target, std::uint64_t number = 0,
                duration requested = 0s, std::size_t size = packet_min) {
  return encode({mote_id{origin}, target, number, instant(requested), size});
}

part only_part(const program& x, duration now = 0s) {
  const auto all = x.parts(instant(now));
  REQUIRE(all.size() == 1);
  return all[0];
}

} // namespace

TEST_CASE("a program without tasks does nothing", "[traffic]") {
  program x;
  CHECK(x.start(instant(0s)).empty());
  CHECK(!x.deadline());
  CHECK(x.parts(instant(1s)).empty());
  CHECK(program_config{}.empty());
  CHECK(!program_config{{sender(mote_id{1})}, {}, false}.empty());
  CHECK(!program_config{{}, relay_config{mote_id{1}}, false}.empty());
  CHECK(!program_config{{}, {}, true}.empty());
}

TEST_CASE("a sender's packets tell who sends what to whom and when", "[traffic]") {
  auto config = sender(mote_id{1});
  config.payload = 50;
  auto x = sending(config);
  const auto first = x.start(instant(0s));
  REQUIRE(first.size() == 1);
  CHECK(first[0].next_hop == mote_id{1});
  CHECK(first[0].ack);
  CHECK(first[0].payload.size() == 48);
  CHECK(x.deadline() == instant(100ms));
  CHECK(x.on_time(instant(99ms)).empty());
  const auto second = x.on_time(instant(100ms));
  REQUIRE(second.size() == 1);
  CHECK(second[0].token != first[0].token);
  const auto a = decode_packet(first[0].payload);
  const auto b = decode_packet(second[0].payload);
  REQUIRE((a && b));
  CHECK(*a == packet{self, mote_id{1}, 0, instant(0s), 48});
  CHECK(*b == packet{self, mote_id{1}, 1, instant(100ms), 48});
  CHECK(x.open() == 2);
}

TEST_CASE("a sender reports a flow from its beginning on", "[traffic]") {
  auto config = sender(mote_id{1});
  config.start = 10s;
  auto x = sending(config);
  CHECK(x.start(instant(0s)).empty());
  const auto flow = only_part(x, 1s);
  CHECK(flow.from == address(self));
  CHECK(flow.to == address(mote_id{1}));
  CHECK(flow.sent == 0);
  CHECK(flow.active == 0s);
}

TEST_CASE("the first hop may be a relay, and acks may be off", "[traffic]") {
  auto config = sender(mote_id{1});
  config.via = mote_id{7};
  config.ack = false;
  const auto out = sending(config).start(instant(0s));
  REQUIRE(out.size() == 1);
  CHECK(out[0].next_hop == mote_id{7});
  CHECK(!out[0].ack);
  CHECK(decode_packet(out[0].payload)->target == mote_id{1});
}

TEST_CASE("a packet is lost at its origin only if it has not arrived", "[traffic]") {
  auto x = sending(sender(mote_id{1}));
  auto token = x.start(instant(0s))[0].token;
  CHECK(x.on_done(token, acked, instant(5ms)).empty());
  CHECK(only_part(x).lost.empty());
  token = x.on_time(instant(100ms))[0].token;
  static_cast<void>(x.on_done(token, ack_lost, instant(120ms)));
  CHECK(only_part(x).lost.empty());
  token = x.on_time(instant(200ms))[0].token;
  static_cast<void>(x.on_done(token, no_ack, instant(220ms)));
  token = x.on_time(instant(300ms))[0].token;
  static_cast<void>(
      x.on_done(token, {true, false, {}, 1}, instant(310ms))); // sent without ack, unheard
  const auto flow = only_part(x, 350ms);
  CHECK(flow.sent == 4);
  CHECK(flow.lost == causes{{"no_ack", 1}, {"unknown", 1}});
  CHECK(flow.transmissions == 1 + 4 + 4 + 1);
  CHECK(flow.delivered == 0);
  CHECK(flow.active == 350ms);
  CHECK(x.open() == 0);
}

TEST_CASE("an answer counts once, and an unknown token not at all", "[traffic]") {
  auto x = sending(sender(mote_id{1}));
  const auto token = x.start(instant(0s))[0].token;
  static_cast<void>(x.on_done(token + 1, no_ack, instant(1ms)));
  CHECK(only_part(x).lost.empty());
  static_cast<void>(x.on_done(token, no_ack, instant(1ms)));
  static_cast<void>(x.on_done(token, no_ack, instant(1ms)));
  CHECK(only_part(x).lost == causes{{"no_ack", 1}});
  CHECK(only_part(x).transmissions == 4);
}

TEST_CASE("a saturated sender has one request open and makes the next when it ends", "[traffic]") {
  auto x = sending(sender(mote_id{1}, arrivals::saturated));
  CHECK(x.start(instant(0s)).empty());
  auto out = x.on_time(x.deadline().value());
  REQUIRE(out.size() == 1);
  CHECK(!x.deadline());
  CHECK(x.on_time(instant(1s)).empty());
  out = x.on_done(out[0].token, no_ack, instant(1s));
  REQUIRE(out.size() == 1);
  CHECK(decode_packet(out[0].payload)->requested == instant(1s));
  CHECK(only_part(x).sent == 2);
  CHECK(x.open() == 1);
}

TEST_CASE("a saturated sender does not spin when it is refused on the spot", "[traffic]") {
  auto x = sending(sender(mote_id{1}, arrivals::saturated));
  CHECK(x.start(instant(0s)).empty());
  const auto begin = x.deadline().value();
  auto out = x.on_time(begin);
  for (int i = 1; i <= 10; ++i) {
    REQUIRE(out.size() == 1);
    const auto now = begin + (i - 1) * 1ms;
    REQUIRE(x.on_done(out[0].token, refused, now).empty());
    REQUIRE(x.deadline() == now + 1ms);
    out = x.on_time(now + 1ms);
  }
  CHECK(only_part(x).sent == 11);
  CHECK(only_part(x).lost == causes{{"queue_full", 10}});
}

TEST_CASE("requests beyond open_max are lost in the program itself", "[traffic]") {
  auto config = sender(mote_id{1});
  config.every = 1ms;
  auto x = sending(config);
  std::size_t asked = x.start(instant(0s)).size();
  for (int i = 1; i < 1024; ++i)
    asked += x.on_time(instant(i * 1ms)).size();
  CHECK(asked == program::open_max);
  CHECK(only_part(x).lost.empty());
  CHECK(x.on_time(instant(1024ms)).empty());
  CHECK(x.deadline() == instant(1025ms));
  CHECK(only_part(x).sent == 1025);
  CHECK(only_part(x).lost == causes{{"queue_full", 1}});
  CHECK(x.open() == program::open_max);
}

TEST_CASE("a saturated sender beside a full program waits, too", "[traffic]") {
  auto periodic = sender(mote_id{1});
  periodic.every = 1us;
  periodic.count = 1024;
  auto saturated = sender(mote_id{3}, arrivals::saturated);
  saturated.start = 1s;
  auto x = make({{periodic, saturated}, {}, false});
  auto out = x.start(instant(0s));
  CHECK(x.on_time(instant(500ms)).size() == 1023); // woken late: what is due is made up for
  CHECK(x.on_time(instant(1s)).empty());
  const auto begin = x.deadline().value();
  CHECK(x.on_time(begin).empty());
  CHECK(x.deadline() == begin + 1ms);
  static_cast<void>(x.on_done(out[0].token, acked, begin));
  CHECK(x.on_time(begin + 1ms).size() == 1);
}

TEST_CASE("each sender of a mote has rng of its own", "[traffic]") {
  auto random = sender(mote_id{1}, arrivals::poisson);
  random.start.reset();
  auto x = sending(random);
  auto y = make({{random, sender(mote_id{3}, arrivals::poisson)}, {}, false});
  static_cast<void>(x.start(instant(0s)));
  static_cast<void>(y.start(instant(0s)));
  std::vector<instant> alone;
  std::vector<instant> beside;
  while (x.deadline() < instant(5s)) {
    for (const auto& out : x.on_time(*x.deadline()))
      alone.push_back(decode_packet(out.payload)->requested);
  }
  while (y.deadline() < instant(5s)) {
    for (const auto& out : y.on_time(*y.deadline())) {
      if (out.next_hop == mote_id{1})
        beside.push_back(decode_packet(out.payload)->requested);
    }
  }
  CHECK(alone.size() > 10);
  CHECK(alone == beside);
}

TEST_CASE("senders to the same mote are one flow, active while one of them is", "[traffic]") {
  auto early = sender(mote_id{1});
  early.stop = 150ms;
  auto late = sender(mote_id{1});
  late.start = 1s;
  late.count = 1;
  auto x = make({{early, late, sender(mote_id{9})}, {}, false});
  static_cast<void>(x.start(instant(0s)));
  static_cast<void>(x.on_time(instant(100ms)));
  while (x.deadline() <= instant(5s))
    static_cast<void>(x.on_time(*x.deadline()));
  const auto flows = x.parts(instant(5s));
  REQUIRE(flows.size() == 2);
  CHECK(flows[0].to == address(mote_id{1}));
  CHECK(flows[0].sent == 3);
  CHECK(flows[0].active == 1100ms);
  CHECK(flows[1].to == address(mote_id{9}));
  CHECK(flows[1].sent == 51);
  CHECK(flows[1].active == 5s);
}

TEST_CASE("a broadcast wants no ack, and its sender never loses it", "[traffic]") {
  auto config = sender(broadcast_mote);
  config.via = mote_id{4}; // means nothing here
  auto x = sending(config);
  const auto out = x.start(instant(0s));
  REQUIRE(out.size() == 1);
  CHECK(out[0].next_hop == broadcast_mote);
  CHECK(!out[0].ack);
  static_cast<void>(
      x.on_done(out[0].token, {false, false, "channel_access_failure", 0}, instant(9ms)));
  static_cast<void>(x.on_time(instant(100ms)));
  x.stop(instant(101ms));
  const auto flow = only_part(x, 200ms);
  CHECK(flow.to == address(broadcast_mote));
  CHECK(flow.sent == 2);
  CHECK(flow.lost.empty());
}

TEST_CASE("a receiver counts each packet for it once", "[traffic]") {
  auto x = receiving();
  CHECK(x.on_packet(mote_id{5}, packet_of(5, self, 0, 10ms, 40), instant(14ms)).empty());
  static_cast<void>(
      x.on_packet(mote_id{5}, packet_of(5, self, 0, 10ms, 40), instant(16ms))); // again
  static_cast<void>(x.on_packet(mote_id{5}, packet_of(5, self, 2, 30ms, 40), instant(36ms)));
  static_cast<void>(x.on_packet(mote_id{5}, packet_of(5, self, 1, 20ms, 40), instant(38ms)));
  static_cast<void>(
      x.on_packet(mote_id{6}, packet_of(5, self, 1, 20ms, 40), instant(39ms))); // detour
  static_cast<void>(x.on_packet(mote_id{6}, packet_of(6, self, 1, 20ms), instant(19ms)));
  const auto flows = x.parts(instant(50ms));
  REQUIRE(flows.size() == 2);
  CHECK(flows[0].from == address(mote_id{5}));
  CHECK(flows[0].to == address(self));
  CHECK(flows[0].delivered == 3);
  CHECK(flows[0].octets == 3 * 42);
  CHECK(flows[0].delay.count() == 3);
  CHECK(flows[0].delay.mean_ms() == Approx((4 + 6 + 18) / 3.0));
  CHECK(flows[0].sent == 0);
  CHECK(flows[0].active == 0s);
  CHECK(flows[1].from == address(mote_id{6}));
  CHECK(flows[1].delivered == 1);
  CHECK(flows[1].delay.mean_ms() == 0); // a clock ahead of ours
}

TEST_CASE("a broadcast is delivered where a receiver is, and passed on by nobody", "[traffic]") {
  const auto octets = packet_of(5, broadcast_mote);
  auto x = receiving();
  static_cast<void>(x.on_packet(mote_id{5}, octets, instant(1ms)));
  static_cast<void>(x.on_packet(mote_id{5}, octets, instant(2ms)));
  CHECK(only_part(x).delivered == 1);
  CHECK(only_part(x).to == address(broadcast_mote));
  auto deaf = relaying(mote_id{1});
  CHECK(deaf.on_packet(mote_id{5}, octets, instant(1ms)).empty());
  CHECK(deaf.parts(instant(1s)).empty());
  static_cast<void>(x.on_packet(mote_id{5}, packet_of(self.value, broadcast_mote), instant(3ms)));
  CHECK(x.parts(instant(1s)).size() == 1);
}

TEST_CASE("what is no measuring packet is counted and dropped", "[traffic]") {
  auto x = receiving();
  CHECK(x.undecodable() == 0);
  CHECK(x.on_packet(mote_id{5}, {}, instant(0s)).empty());
  CHECK(x.on_packet(mote_id{5}, bytes(packet_min), instant(0s)).empty());
  CHECK(x.on_packet(mote_id{5}, bytes(packet_max + 1), instant(0s)).empty());
  CHECK(x.undecodable() == 3);
  CHECK(x.parts(instant(0s)).empty());
}

TEST_CASE("a relay passes on what is for others, unchanged", "[traffic]") {
  auto x = make({{}, relay_config{mote_id{1}, false}, true});
  const auto octets = packet_of(5, mote_id{9}, 4, 1s, 60);
  const auto out = x.on_packet(mote_id{5}, octets, instant(2s));
  REQUIRE(out.size() == 1);
  CHECK(out[0].next_hop == mote_id{1});
  CHECK(out[0].payload == octets);
  CHECK(!out[0].ack);
  CHECK(
      x.on_packet(mote_id{5}, packet_of(5, self, 5), instant(2s)).empty()); // for the relay itself
  static_cast<void>(x.on_done(out[0].token, no_ack, instant(3s)));
  const auto flows = x.parts(instant(4s));
  REQUIRE(flows.size() == 2);
  CHECK(flows[0].to == address(self));
  CHECK(flows[0].delivered == 1);
  CHECK(flows[1].to == address(mote_id{9}));
  CHECK(flows[1].sent == 0);
  CHECK(flows[1].lost == causes{{"no_ack", 1}});
  CHECK(flows[1].transmissions == 4);
  CHECK(flows[1].active == 0s);
}

TEST_CASE("a relay passes on once what comes twice, and does not count it as lost", "[traffic]") {
  auto x = relaying(mote_id{1});
  const auto octets = packet_of(5, mote_id{1}, 4);
  const auto out = x.on_packet(mote_id{5}, octets, instant(1s));
  REQUIRE(out.size() == 1);
  CHECK(x.on_packet(mote_id{5}, octets, instant(1s)).empty());
  static_cast<void>(x.on_done(out[0].token, ack_lost, instant(2s)));
  CHECK(x.on_packet(mote_id{5}, octets, instant(3s)).empty());
  CHECK(only_part(x).lost.empty());
}

TEST_CASE("a packet that has gone in a circle is lost where it comes round, once", "[traffic]") {
  auto x = relaying(mote_id{3});
  const auto octets = packet_of(5, mote_id{1}, 4);
  CHECK(x.on_packet(mote_id{5}, octets, instant(1s)).size() == 1);
  CHECK(x.on_packet(mote_id{6}, octets, instant(2s)).empty());
  CHECK(x.on_packet(mote_id{6}, octets, instant(3s)).empty()); // did not hear our ack
  CHECK(only_part(x).lost == causes{{"loop", 1}});
  const auto own = packet_of(self.value, mote_id{1}, 4);
  CHECK(x.on_packet(mote_id{6}, own, instant(4s)).empty());
  CHECK(x.on_packet(mote_id{6}, own, instant(5s)).empty());
  const auto flows = x.parts(instant(6s));
  REQUIRE(flows.size() == 2);
  CHECK(flows[0].from == address(self));
  CHECK(flows[0].lost == causes{{"loop", 1}});
}

TEST_CASE("a relay with open_max requests open loses what comes", "[traffic]") {
  auto x = relaying(mote_id{1});
  std::vector<std::uint64_t> tokens;
  for (std::uint64_t i = 0; i < program::open_max; ++i)
    tokens.push_back(x.on_packet(mote_id{5}, packet_of(5, mote_id{1}, i), instant(1s)).at(0).token);
  CHECK(only_part(x).lost.empty());
  CHECK(x.on_packet(mote_id{5}, packet_of(5, mote_id{1}, 2000), instant(1s)).empty());
  CHECK(x.on_packet(mote_id{5}, packet_of(5, mote_id{1}, 2000), instant(1s)).empty()); // the same
  CHECK(only_part(x).lost == causes{{"queue_full", 1}});
  static_cast<void>(x.on_done(tokens[0], acked, instant(2s)));
  CHECK(x.on_packet(mote_id{5}, packet_of(5, mote_id{1}, 2001), instant(2s)).size() == 1);
}

TEST_CASE("a packet that nobody here is meant to have is lost, once", "[traffic]") {
  auto x = sending(sender(mote_id{1}));
  for (int i = 0; i < 2; ++i) {
    CHECK(x.on_packet(mote_id{5}, packet_of(5, self, 0), instant(1s)).empty());
    CHECK(x.on_packet(mote_id{5}, packet_of(5, mote_id{1}, 1), instant(1s)).empty());
  }
  const auto flows = x.parts(instant(1s));
  REQUIRE(flows.size() == 3);
  CHECK(flows[1].lost == causes{{"no_relay", 1}});
  CHECK(flows[2].lost == causes{{"no_receiver", 1}});
}

TEST_CASE("a mote that loses its power loses what is open", "[traffic]") {
  auto x = make({{sender(mote_id{1})}, relay_config{mote_id{1}}, true});
  const auto own = x.start(instant(0s))[0].token;
  const auto passed = x.on_packet(mote_id{5}, packet_of(5, mote_id{1}), instant(1ms))[0].token;
  x.stop(instant(50ms));
  CHECK(!x.deadline());
  CHECK(x.on_time(instant(1s)).empty());
  auto flows = x.parts(instant(1s));
  REQUIRE(flows.size() == 2);
  CHECK(flows[0].lost == causes{{"aborted", 1}});
  CHECK(flows[0].active == 50ms);
  CHECK(flows[1].lost == causes{{"aborted", 1}});

  // Late answers tell the truth: one packet had arrived when the power went.
  CHECK(x.on_done(own, {false, true, "aborted", 1}, instant(60ms)).empty());
  CHECK(x.on_done(passed, {false, false, "no_ack", 2}, instant(60ms)).empty());
  flows = x.parts(instant(1s));
  CHECK(flows[0].lost.empty());
  CHECK(flows[1].lost == causes{{"no_ack", 1}});
}

TEST_CASE("what comes to a mote without power is lost", "[traffic]") {
  auto x = make({{}, relay_config{mote_id{1}}, true});
  x.stop(instant(1s));
  for (int i = 0; i < 2; ++i) {
    CHECK(x.on_packet(mote_id{5}, packet_of(5, mote_id{1}, 0), instant(2s)).empty());
    CHECK(x.on_packet(mote_id{5}, packet_of(5, self, 1), instant(2s)).empty());
    CHECK(x.on_packet(mote_id{5}, packet_of(5, broadcast_mote, 2), instant(2s)).empty());
  }
  const auto flows = x.parts(instant(3s));
  REQUIRE(flows.size() == 2);
  for (const auto& flow : flows) {
    CHECK(flow.delivered == 0);
    CHECK(flow.lost == causes{{"aborted", 1}});
  }
}

TEST_CASE("the packets and tokens of a mote's next life are new", "[traffic]") {
  auto target = receiving();
  std::uint64_t last_token = 0;
  auto config = sender(self);
  for (const auto boot : {0s, 2s, 30s}) {
    program origin({{config}, {}, false}, address(mote_id{5}), random_stream(1));
    auto out = origin.start(instant(boot));
    for (int i = 1; i < 10; ++i) {
      const auto more = origin.on_time(*origin.deadline());
      out.insert(out.end(), more.begin(), more.end());
    }
    REQUIRE(out.size() == 10);
    for (const auto& x : out) {
      CHECK((boot == 0s || x.token > last_token));
      last_token = x.token;
      static_cast<void>(target.on_packet(mote_id{5}, x.payload, instant(boot + 2s)));
    }
  }
  CHECK(only_part(target).delivered == 30);
}

TEST_CASE("a program knows flows_max flows, and counts what is of more", "[traffic]") {
  auto x = receiving();
  std::size_t flows = 0;
  for (std::uint16_t target = 10; flows < program::flows_max; ++target) {
    // No relay here: each packet is lost, and each loss is of another flow.
    for (std::uint16_t origin = 100; origin < 4196 && flows < program::flows_max; ++origin, ++flows)
      static_cast<void>(
          x.on_packet(mote_id{1}, packet_of(origin, mote_id{target}, target), instant(0s)));
  }
  CHECK(x.undecodable() == 0);
  static_cast<void>(x.on_packet(mote_id{1}, packet_of(100, self, 500), instant(0s)));
  CHECK(x.undecodable() == 1);
  CHECK(x.parts(instant(0s)).size() == program::flows_max);
}
