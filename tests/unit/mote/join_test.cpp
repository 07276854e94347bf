#include "mote/join/join_client.hpp"
#include "support/catch.hpp"
#include "support/mote_ids.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::mote;
using test::pick;
using test::the_sink;

namespace {

join_client make_client() {
  join_config config;
  config.start_jitter = 0s;
  return {config, bytes{0xaa}, 3, random_stream(1)};
}

/// Lets the client reach its deadline.
join_outputs wait(join_client& client, instant& now) {
  now = *client.deadline();
  return client.on_time(now);
}

join_request request_in(const join_outputs& out) {
  REQUIRE(pick<to_registrar>(out).size() == 1);
  return std::get<join_request>(pick<to_registrar>(out)[0].message);
}

} // namespace

TEST_CASE("a mote asks, is answered, confirms and is in", "[mote][DIS-08]") {
  auto client = make_client();
  instant now{};
  CHECK(client.start(1, now).empty());
  const auto out = wait(client, now);
  const auto request = request_in(out);
  CHECK(request.incarnation == 3);
  CHECK(request.descriptor == bytes{0xaa});

  const join_reply reply{request.sequence, island_id{1}, mote_id{7}, 0, {}};
  const auto in = client.on_message(the_sink, reply, now);
  REQUIRE(pick<island_joined>(in).size() == 1);
  CHECK(pick<island_joined>(in)[0].island == island_id{1});
  CHECK(pick<island_joined>(in)[0].sink == the_sink);
  CHECK(std::get<join_confirm>(pick<to_registrar>(in)[0].message) ==
        join_confirm{request.sequence, 3, bytes{0xaa}});
  CHECK(client.current() == join_client::state::joined);

  SECTION("a repeated reply is confirmed again, without joining twice") {
    const auto again = client.on_message(the_sink, reply, now);
    CHECK(pick<island_joined>(again).empty());
    CHECK(pick<to_registrar>(again).size() == 1);
  }
  SECTION("a prompt counts from the sink and from the root of the tree") {
    CHECK(pick<island_lost>(client.on_message(mote_id{8}, rejoin_prompt{}, now)).empty());
    CHECK(
        pick<island_lost>(client.on_message(mote_id{8}, rejoin_prompt{}, now, mote_id{9})).empty());
    CHECK(
        pick<island_lost>(client.on_message(mote_id{8}, rejoin_prompt{}, now, mote_id{8})).size() ==
        1);
  }
  SECTION("a silent mote says that it is still there") {
    const auto before = now;
    const auto alive = wait(client, now);
    CHECK(now - before == 3s);
    CHECK(std::get<keep_alive>(pick<to_registrar>(alive)[0].message).incarnation == 3);
    client.on_sent(now + 1s);
    CHECK(*client.deadline() == now + 4s);
  }
  SECTION("a mote that its sink has forgotten joins again") {
    CHECK(client.on_message(mote_id{9}, rejoin_prompt{}, now).empty());
    CHECK(pick<island_lost>(client.on_message(the_sink, rejoin_prompt{}, now)).size() == 1);
    CHECK(request_in(wait(client, now)).sequence != request.sequence);
  }
  SECTION("a leaving mote notifies its sink and falls silent") {
    const auto bye = client.leave();
    CHECK(std::holds_alternative<leave_notice>(pick<to_registrar>(bye).at(0).message));
    CHECK_FALSE(client.deadline().has_value());
    CHECK(client.on_message(the_sink, reply, now).empty());
    CHECK(client.leave().empty());
  }
}

TEST_CASE("an unanswered mote asks five times, pauses longer and longer, and never gives up",
          "[mote][DIS-08]") {
  auto client = make_client();
  instant now{};
  static_cast<void>(client.start(1, now));
  std::vector<duration> pauses;
  for (int round = 0; round < 7; ++round) {
    for (int attempt = 0; attempt < 5; ++attempt) {
      static_cast<void>(request_in(wait(client, now)));
      CHECK(*client.deadline() - now == 500ms);
    }
    CHECK(wait(client, now).empty());
    pauses.push_back(*client.deadline() - now);
  }
  for (std::size_t i = 0; i < pauses.size(); ++i) {
    const auto base = std::min<duration>(2s * (1 << i), 30s);
    CHECK(pauses[i] >= base);
    CHECK(pauses[i] <= base * 3 / 2);
  }
}

TEST_CASE("a reply to an older request is ignored", "[mote][DIS-08]") {
  auto client = make_client();
  instant now{};
  static_cast<void>(client.start(1, now));
  const auto first = request_in(wait(client, now));
  static_cast<void>(wait(client, now));
  CHECK(
      client.on_message(the_sink, join_reply{first.sequence, island_id{1}, mote_id{7}, 0, {}}, now)
          .empty());
}

TEST_CASE("a mote with rare keep-alives says early that it believes itself joined",
          "[mote][DIS-08][DIS-05]") {
  join_config config;
  config.keep_alive = 30s;
  join_client client(config, {}, 0, random_stream(1));
  instant now{};
  static_cast<void>(client.start(1, now));
  const auto request = request_in(wait(client, now));
  const join_reply reply{request.sequence, island_id{1}, mote_id{7}, 0, {}};
  static_cast<void>(client.on_message(the_sink, reply, now));
  for (const auto gap : {4s, 8s, 16s, 30s, 30s}) {
    const auto before = now;
    static_cast<void>(wait(client, now));
    CHECK(now - before == gap);
  }
  static_cast<void>(client.on_message(the_sink, reply, now)); // its confirm had been lost
  CHECK(*client.deadline() == now + 4s);
}

TEST_CASE("motes that start together do not all ask at once", "[mote][DIS-05]") {
  join_config config;
  join_client a(config, {}, 0, random_stream(1));
  join_client b(config, {}, 0, random_stream(2));
  static_cast<void>(a.start(1, {}));
  static_cast<void>(b.start(1, {}));
  CHECK(*a.deadline() != *b.deadline());
  CHECK(*a.deadline() < instant{1s});
}

TEST_CASE("where frames wait for their turn, a mote waits longer for its answer, and its "
          "keep-alives come at times of its own",
          "[mote][DIS-08][SYN-16]") {
  join_config config;
  const auto joined = [&config](std::uint64_t seed) {
    join_client x(config, {}, 0, random_stream(seed));
    x.set_turn_wait(500ms);
    instant now;
    static_cast<void>(x.start(1, now));
    const auto asked = request_in(wait(x, now));
    CHECK(*x.deadline() - now == 1500ms);
    static_cast<void>(x.on_message(
        the_sink, join_reply{asked.sequence, island_id{1}, mote_id{7}, 0, {}}, instant{2s}));
    CHECK(*x.deadline() > instant{2s} + config.keep_alive * 3 / 4);
    CHECK(*x.deadline() <= instant{2s} + config.keep_alive);
    return *x.deadline();
  };
  CHECK(joined(1) != joined(2));
}

TEST_CASE("a mote many hops away waits longer for its answer", "[mote][DIS-08][NET-11]") {
  auto client = make_client();
  instant now{};
  static_cast<void>(client.start(4, now));
  CHECK(*client.deadline() <= instant{3s}); // spread over a second for each further hop
  static_cast<void>(request_in(wait(client, now)));
  CHECK(*client.deadline() - now == 2s);
}

TEST_CASE("a mote whose address another has is silent, and asks again ever more rarely",
          "[mote][ADR-04]") {
  auto client = make_client();
  instant now{};
  static_cast<void>(client.start(1, now));
  duration last{};
  for (int i = 0; i < 8; ++i) {
    CAPTURE(i);
    const auto request = request_in(wait(client, now));
    const auto other = static_cast<std::uint16_t>(request.sequence + 1);
    CHECK(client.on_message(the_sink, join_refusal{other}, now).empty()); // meant for another
    const auto out = client.on_message(the_sink, join_refusal{request.sequence}, now);
    REQUIRE(pick<join_refused>(out).size() == 1);
    CHECK(client.current() == join_client::state::refused);
    CHECK(client.on_message(the_sink, rejoin_prompt{}, now).empty());
    const join_reply late{request.sequence, island_id{1}, mote_id{7}, 0, {}};
    CHECK(client.on_message(the_sink, late, now).empty());
    const auto silence = *client.deadline() - now;
    CHECK(silence >= std::min<duration>(30s * (1 << i), 10min));
    CHECK(silence <= 15min);
    CHECK((i < 2 || silence > last || silence >= 10min));
    last = silence;
    CHECK(pick<join_resumed>(wait(client, now)).size() == 1);
    CHECK(client.current() == join_client::state::requesting);
  }
}

TEST_CASE("two motes with one address do not count their requests alike", "[mote][ADR-04]") {
  const auto first_request = [](std::uint64_t seed) {
    join_config config;
    config.start_jitter = 0s;
    join_client client(config, bytes{0xaa}, 0, random_stream(seed), 0xa1);
    instant now{};
    static_cast<void>(client.start(1, now));
    return request_in(wait(client, now)).sequence;
  };
  CHECK(first_request(1) != first_request(2));
}
