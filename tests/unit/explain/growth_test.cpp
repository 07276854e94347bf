// Which step comes after which, by the numbers of records alone.
#include "explain/growth.hpp"
#include "explain/tuples.hpp"
#include "support/catch.hpp"
#include "unit/explain/fixture.hpp"

using namespace rubicon;
using namespace rubicon::explain;
using namespace rubicon::test;

namespace {

record numbered(std::uint64_t number, std::uint64_t cause, kind what = kind::radio_send,
                std::string text = {}) {
  record r;
  r.number = number;
  r.cause = cause;
  r.what = what;
  r.text = std::move(text);
  r.time = instant(std::chrono::milliseconds(number));
  return r;
}

/// One message, whose first step stands for number 1.
struct one_message {
  growth all{explain_fixture().x.about};
  node_index root;

  one_message() {
    all.all.messages.emplace_back();
    all.note(numbered(1, 0, kind::begun, "message"));
    node x;
    root = all.add(x, no_node);
    all.all.messages.front().root = root;
    all.stands_for(1, root);
  }

  node_index hop(std::uint64_t cause, std::uint32_t fragments = 1) {
    return all.hop_for({{}, medium::air, near_mote, far_mote, any_peer, fragments}, cause,
                       numbered(0, cause));
  }
};

} // namespace

TEST_CASE("a number stands for the step of its nearest cause", "[explain]") {
  one_message x;
  x.all.note(numbered(2, 1));
  x.all.note(numbered(3, 2));
  x.all.note(numbered(4, 0));
  CHECK(x.all.step_of(3) == x.root);
  CHECK(x.all.step_of(4) == no_node);
  CHECK(x.all.step_of(77) == no_node);
  CHECK(x.all.step_of(0) == no_node);
}

TEST_CASE("causes that go round in a circle end", "[explain]") {
  growth all{explain_fixture().x.about};
  all.note(numbered(5, 5));
  all.note(numbered(6, 9));
  all.note(numbered(9, 6));
  CHECK(all.step_of(5) == no_node);
  CHECK(all.step_of(9) == no_node);
  CHECK(all.begun(9, "message") == 0);
}

TEST_CASE("what has begun is looked for up to the next step", "[explain]") {
  one_message x;
  x.all.note(numbered(2, 1, kind::begun, "attempt"));
  x.all.note(numbered(3, 2));
  x.all.note(numbered(4, 3, kind::begun, "message"));
  CHECK(x.all.begun(3, "attempt") == 2);
  CHECK(x.all.begun(4, "attempt") == 2);
  CHECK(x.all.begun(4, "message") == 4);
  CHECK(x.all.begun(3, "message") == 0); // it stands for a step already
}

TEST_CASE("what the same has led to is tried again, what another attempt has led to is not",
          "[explain]") {
  one_message x;
  x.all.note(numbered(2, 1, kind::begun, "attempt"));
  x.all.note(numbered(3, 1, kind::begun, "attempt"));
  const auto first = x.hop(2);
  CHECK(x.hop(2) == first);
  CHECK(x.hop(3) != first);
  CHECK(x.all.all.messages.front().sends == 2);
}

TEST_CASE("a hop has arrived when all its fragments have", "[explain][NET-14]") {
  one_message x;
  const auto hop = x.hop(1, 3);
  x.all.note(numbered(2, 1));
  x.all.arrive(hop, 0, far_mote, numbered(2, 1));
  x.all.arrive(hop, 0, far_mote, numbered(3, 1)); // again
  x.all.arrive(hop, 2, far_mote, numbered(4, 1));
  CHECK(!x.all.at(hop).arrived);
  x.all.arrive(hop, 1, far_mote, numbered(5, 1));
  CHECK(x.all.at(hop).arrived == instant(5ms));
  CHECK(x.all.step_of(2) == hop);
}

TEST_CASE("a value is heard of by what it has led to, whatever others it equals", "[explain]") {
  growth all{explain_fixture().x.about};
  tuple_follower tuples(all);
  for (const std::uint64_t number : {1U, 2U}) {
    auto r = numbered(number, 0, kind::set_tuple, "kitchen.near.state");
    r.to = pc_kernel;
    r.octets = {'x'};
    all.note(r);
    tuples.on_set(r, false);
  }
  auto event = numbered(3, 1, kind::tuple_event, "kitchen.near.state");
  event.to = "proxy/kitchen.near";
  all.note(event);
  tuples.on_event(event);
  REQUIRE(all.all.tuples.size() == 2);
  CHECK(all.all.tuples[0].nodes.size() == 2);
  CHECK(all.all.tuples[1].nodes.size() == 1);
}

TEST_CASE("a kernel's own value begins with the first package that carries it", "[explain]") {
  growth all{explain_fixture().x.about};
  tuple_follower tuples(all);
  peis::tuple x;
  x.owner = peer_id{11};
  x.name = *peis::key::parse("kernel.version");
  x.value = peis::text_content("1").value;
  auto package = numbered(2, 1, kind::link_octets);
  package.from = pc_kernel;
  CHECK(!tuples.recognise(x, 1, package)); // nothing has begun
  all.note(numbered(1, 0, kind::begun, "value"));
  CHECK(!tuples.recognise(std::nullopt, 1, package));
  const auto what = tuples.recognise(x, 1, package);
  REQUIRE(what);
  CHECK(what->about == subject{true, 0});
  CHECK(tuples.recognise(std::nullopt, 1, package)->about == what->about);
  CHECK(all.all.tuples.front().key == "kernel.version");
}
