// One medium at a time.
#include "explain/media.hpp"
#include "support/catch.hpp"
#include "unit/explain/fixture.hpp"

using namespace rubicon;
using namespace rubicon::explain;
using namespace rubicon::test;

namespace {

struct followers {
  growth all{explain_fixture().x.about};
  message_follower messages{all};
  tuple_follower tuples{all};
  air_follower air{all, messages};
  line_follower line{all, messages};
  link_follower links{all, messages, tuples};
  std::uint64_t number = 0;

  /// @returns it, numbered
  record take(record r, void (line_follower::*what)(const record&)) {
    r.number = ++number;
    all.note(r);
    (line.*what)(r);
    return r;
  }

  /// A reading that a mote has given itself. @returns its number
  std::uint64_t begin_message() {
    record r;
    r.number = ++number;
    r.what = kind::send_message;
    r.from = r.to = near_mote;
    r.mote = {own_island, no_mote};
    r.channel = 2;
    r.octets = reading;
    all.note(r);
    messages.on_send(r);
    return r.number;
  }
};

bytes line_octets() {
  transport::segment plain;
  plain.source = mote_id{7};
  plain.am_type = 2;
  plain.payload = reading;
  return explain_fixture::serial(
      {1, 7, 1, network::am::to_gateway, explain_fixture::packet_up(plain)}, false);
}

record on_line(kind what, const std::string& from, const std::string& to, std::uint64_t cause) {
  record r;
  r.what = what;
  r.from = from;
  r.to = to;
  r.cause = cause;
  r.octets = line_octets();
  return r;
}

record written(std::uint64_t cause) {
  return on_line(kind::serial_write, sink_actor, line_actor, cause);
}

record come(std::uint64_t cause) {
  return on_line(kind::serial_octets, line_actor, gateway_actor, cause);
}

std::vector<std::string> outcomes(const followers& x, std::uint32_t message) {
  std::vector<std::string> all;
  for (const auto n : x.all.all.messages[message].nodes)
    for (const auto& each : x.all.all.nodes[n].attempts)
      all.push_back(each.outcome);
  return all;
}

using words = std::vector<std::string>;

} // namespace

TEST_CASE("equal octets on a line are told apart by what wrote them", "[explain]") {
  followers x;
  const auto first = x.begin_message();
  const auto second = x.begin_message();
  static_cast<void>(x.take(written(first), &line_follower::on_write));
  const auto last = x.take(written(second), &line_follower::on_write);
  static_cast<void>(x.take(come(last.number), &line_follower::on_octets));
  CHECK(outcomes(x, 0) == words{"lost on the line"});
  CHECK(outcomes(x, 1) == words{"delivered"});
  CHECK(!x.all.all.messages[0].delivered);
  CHECK(x.all.all.messages[1].delivered);
}

TEST_CASE("octets that nobody has written are nobody's", "[explain]") {
  followers x;
  const auto message = x.begin_message();
  static_cast<void>(x.take(written(message), &line_follower::on_write));
  static_cast<void>(x.take(come(77), &line_follower::on_octets));
  CHECK(outcomes(x, 0) == words{""});
}

TEST_CASE("an unplugged cable loses what is in flight and what is written then",
          "[explain][GW-16]") {
  followers x;
  record plug;
  plug.what = kind::plug_serial;
  plug.to = line_actor;
  static_cast<void>(x.take(written(x.begin_message()), &line_follower::on_write));
  static_cast<void>(x.take(plug, &line_follower::on_plug));
  static_cast<void>(x.take(written(x.begin_message()), &line_follower::on_write));
  CHECK(outcomes(x, 0) == words{"cable unplugged"});
  CHECK(outcomes(x, 1) == words{"cable unplugged"});
}

TEST_CASE("a request that fails is where its own value ends", "[explain]") {
  followers x;
  std::vector<std::uint64_t> asked;
  for (int i = 0; i < 2; ++i) {
    record r;
    r.number = ++x.number;
    r.what = kind::set_remote_tuple;
    r.from = "proxy/kitchen.near";
    r.to = pc_kernel;
    r.id = 5; // the same token
    r.peer = 30;
    r.text = "robot.goal";
    x.all.note(r);
    x.links.on_asked(r, *x.tuples.on_set_remote(r));
    asked.push_back(r.number);
  }
  record failed;
  failed.what = kind::peis_outcome;
  failed.number = ++x.number;
  failed.from = pc_kernel;
  failed.cause = asked[1];
  failed.text = "no_route";
  x.links.on_outcome(failed);
  CHECK(x.all.all.tuples[0].nodes.size() == 1);
  REQUIRE(x.all.all.tuples[1].nodes.size() == 2);
  CHECK(x.all.all.nodes[x.all.all.tuples[1].nodes[1]].failure == "no_route");
}

namespace {

/// From the mote `far`, a further sink, to the island's sink.
class backbone_world {
public:
  /// A reading of the mote is given to the backbone. @returns the message
  std::uint32_t write() {
    const auto cause = x_.begin_message();
    transport::segment plain;
    plain.source = mote_id{7};
    plain.am_type = 2;
    plain.payload = reading;
    record r;
    r.what = kind::backbone_write;
    r.from = far_mote;
    r.to = link_;
    r.cause = cause;
    r.channel = network::am::up;
    r.octets = explain_fixture::up(7, 1, explain_fixture::whole(explain_fixture::packet_up(plain)));
    writes_.push_back(put(std::move(r), &backbone_follower::on_write));
    return static_cast<std::uint32_t>(x_.all.all.messages.size() - 1);
  }

  void receive(std::size_t write, bool unheard = false) {
    record r;
    r.what = kind::backbone_received;
    r.from = link_;
    r.to = sink_actor;
    r.cause = writes_.at(write);
    r.unheard = unheard;
    static_cast<void>(put(std::move(r), &backbone_follower::on_received));
  }

  void plug(bool plugged) {
    record r;
    r.what = kind::plug_serial;
    r.to = link_;
    r.yes = plugged;
    static_cast<void>(put(std::move(r), &backbone_follower::on_plug));
  }

  [[nodiscard]] words outcomes(std::uint32_t message) const { return ::outcomes(x_, message); }
  [[nodiscard]] const node& last_hop(std::uint32_t message) const {
    return x_.all.all.nodes[x_.all.all.messages[message].nodes.back()];
  }

private:
  std::uint64_t put(record r, void (backbone_follower::*what)(const record&)) {
    r.number = ++x_.number;
    x_.all.note(r);
    (backbones_.*what)(r);
    return r.number;
  }

  std::string link_ = "backbone/kitchen/far";
  followers x_;
  backbone_follower backbones_{x_.all, x_.air};
  std::vector<std::uint64_t> writes_;
};

} // namespace

TEST_CASE("a backbone's packets are a hop, and those overtaken are lost", "[explain]") {
  backbone_world x;
  const auto first = x.write();
  const auto second = x.write();
  const auto third = x.write();
  x.receive(1);
  CHECK(x.outcomes(first) == words{"lost on the backbone"});
  CHECK(x.outcomes(second) == words{"delivered"});
  CHECK(x.outcomes(third) == words{""});
  CHECK(x.last_hop(second).over == medium::backbone);
  CHECK(x.last_hop(second).from == far_mote);
  CHECK(x.last_hop(second).to == sink_actor);
  CHECK(x.last_hop(second).arrived);
  x.receive(2, true);
  CHECK(x.outcomes(third) == words{"the receiver had ended"});
}

TEST_CASE("a backbone that is cut loses what is in flight and what is written then", "[explain]") {
  backbone_world x;
  const auto first = x.write();
  const auto second = x.write();
  x.plug(false);
  x.receive(0); // at that moment
  const auto third = x.write();
  x.plug(true);
  const auto fourth = x.write();
  x.receive(3);
  CHECK(x.outcomes(first) == words{"delivered"});
  CHECK(x.outcomes(second) == words{"backbone cut"});
  CHECK(x.outcomes(third) == words{"backbone cut"});
  CHECK(x.outcomes(fourth) == words{"delivered"});
}
