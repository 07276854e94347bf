#include <deque>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/account/message_ledger.hpp"
#include "core/tuples/hand_over.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

const mote_address fan{island_id(1), mote_id(4)};
const mote_address pc{island_id(1), no_mote};

/// An actor as far as the ledger sees it.
class node : public provenance_source {
public:
  node(std::string place, message_ledger& ledger) : place_(std::move(place)), ledger_(&ledger) {}

  [[nodiscard]] std::uint64_t begin(std::string_view, std::uint64_t) override { return 0; }
  [[nodiscard]] message_ledger* ledger() override { return ledger_; }
  [[nodiscard]] std::string_view place() const override { return place_; }
  [[nodiscard]] instant time() const override { return now; }

  instant now;

private:
  std::string place_;
  message_ledger* ledger_;
};

struct packet {
  int content = 0;
  provenance from = {};
};

/// What a program sends: a copy in a queue.
packet sent(message_kind kind = message_kind::message) {
  const acting_on its_copies(begin_message(kind, fan, pc));
  return packet{1};
}

message_tally tally(const message_ledger& x, message_kind kind = message_kind::message) {
  return x.of(fan, kind);
}

std::uint64_t lost(const message_tally& x, loss why) {
  const auto found = x.lost.find(why);
  return found == x.lost.end() ? 0 : found->second;
}

} // namespace

TEST_CASE("a message is in transit as long as there is a copy, then lost at its newest note",
          "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node mote("mote/kitchen/fan", *ledger);
  const turn_of turn(&mote);
  std::deque<packet> queue{sent()};
  CHECK(tally(*ledger).in_transit() == 1);
  queue.push_back(queue.front()); // a repeat
  note_loss(queue.front().from, loss::queue_full);
  queue.pop_front();
  CHECK(tally(*ledger).in_transit() == 1);
  mote.now = instant(1s);
  note_loss(queue.front().from, loss::gave_up);
  queue.pop_front();
  const auto x = tally(*ledger);
  CHECK(x.in_transit() == 0);
  CHECK(lost(x, loss::gave_up) == 1);
  CHECK(x.lost_in_all() == 1);
  CHECK(ledger->lost_at() ==
        message_ledger::places{{{message_kind::message, loss::gave_up, "mote/kitchen/fan"}, 1}});
}

TEST_CASE("a message arrives once, whatever becomes of its other copies", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node gateway("gateway/kitchen", *ledger);
  const turn_of turn(&gateway);
  auto first = sent();
  auto second = first;
  for (auto* each : {&first, &second}) {
    const acting_on its(each->from);
    note_arrival(message_kind::message, fan);
  }
  note_loss(second.from, loss::queue_full);
  first = second = packet{0, provenance::none()};
  CHECK(tally(*ledger).arrived == 1);
  CHECK(tally(*ledger).sent == 1);
  CHECK(tally(*ledger).lost_in_all() == 0);
}

TEST_CASE("what a message has led to is no copy of it", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node gateway("gateway/kitchen", *ledger);
  const turn_of turn(&gateway);
  const auto x = sent();
  const acting_on its(x.from);
  note_arrival(message_kind::message, mote_address{island_id(1), mote_id(9)});
  note_arrival(message_kind::channel, std::nullopt);
  CHECK(tally(*ledger).arrived == 0);
}

TEST_CASE("a refused message was never sent", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node mote("mote/kitchen/fan", *ledger);
  const turn_of turn(&mote);
  {
    const acting_on its_copies(begin_message(message_kind::message, fan, pc));
    refuse_message();
  }
  CHECK(tally(*ledger).sent == 0);
  CHECK(tally(*ledger).in_transit() == 0);
  CHECK(tally(*ledger).lost_in_all() == 0);
}

TEST_CASE("a loss that is not noted, or that a stop has caused, is seen", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node mote("mote/kitchen/fan", *ledger);
  const turn_of turn(&mote);
  static_cast<void>(sent());
  CHECK(lost(tally(*ledger), loss::unknown) == 1);
  auto held = sent();
  {
    const stopping its_copies;
    held = packet{0, provenance::none()};
  }
  CHECK(lost(tally(*ledger), loss::node_stopped) == 1);
}

TEST_CASE("that a repeat was recognised is the cause only if nothing else is", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node sink("sink/kitchen", *ledger);
  const turn_of turn(&sink);
  auto x = sent();
  note_loss(x.from, loss::gave_up);
  sink.now = instant(1s);
  note_loss(x.from, loss::duplicate);
  x = packet{0, provenance::none()};
  CHECK(lost(tally(*ledger), loss::gave_up) == 1);
  auto y = sent();
  note_loss(y.from, loss::duplicate);
  y = packet{0, provenance::none()};
  CHECK(lost(tally(*ledger), loss::duplicate) == 1);
}

TEST_CASE("copies on a PEIS link are found again, or lost after a minute", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node peer("peis_peer/kitchen", *ledger);
  const turn_of turn(&peer);
  const auto depart = [](std::uint64_t name, bool leaves) {
    const auto x = sent();
    const acting_on its(x.from);
    package_departs(name, leaves);
  };
  depart(7, false);
  CHECK(tally(*ledger).in_transit() == 1);
  {
    const acting_on its(package_comes(7));
    note_arrival(message_kind::message, fan);
  }
  CHECK(tally(*ledger).arrived == 1);
  depart(8, false);
  depart(9, true);
  ledger->package_lost(8);
  CHECK(lost(tally(*ledger), loss::package_lost) == 1);
  peer.now = instant(message_ledger::package_lifetime);
  depart(10, false);
  CHECK(tally(*ledger).handed_over == 1);
  CHECK(tally(*ledger).in_transit() == 1);
  peer.now += message_ledger::package_lifetime;
  depart(11, false);
  CHECK(lost(tally(*ledger), loss::package_lost) == 2);
  ledger->package_lost(11);
  CHECK(tally(*ledger).in_transit() == 0);
}

TEST_CASE("what was handed over a minute ago is not on its way any more", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node peer("peer/kitchen", *ledger);
  const turn_of turn(&peer);
  const auto lately = [&] {
    return ledger->tallied().at({fan, message_kind::message}).handed_lately;
  };
  const auto hand_one_over = [&](duration at) {
    peer.now = instant(at);
    const auto one = sent();
    const acting_on its(one.from);
    hand_over();
  };
  hand_one_over(1s);
  hand_one_over(31s); // now the first one is known to have left
  CHECK(lately() == 1);
  hand_one_over(61s);
  CHECK(tally(*ledger).handed_over == 2);
  CHECK(lately() == 2);
  peer.now = instant(62s);
  CHECK(lately() == 1);
  peer.now = instant(130s);
  CHECK(tally(*ledger).handed_over == 2);
  CHECK(lately() == 0);
  ledger->finish();
  CHECK(tally(*ledger).handed_over == 3);
  CHECK(lately() == 0);
}

TEST_CASE("what has come from another process is counted for its sender", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  node gateway("gateway/kitchen", *ledger);
  const turn_of turn(&gateway);
  note_arrival(message_kind::message, fan);
  CHECK(ledger->foreign_arrivals().at({fan, message_kind::message}) == 1);
  CHECK(tally(*ledger).arrived == 0);
}

TEST_CASE("each end is notified once", "[core][ledger]") {
  const auto ledger = message_ledger::make();
  std::vector<message_end> ends;
  ledger->observe([&](const message_end& x) { ends.push_back(x); });
  node mote("mote/kitchen/fan", *ledger);
  mote.now = instant(3s);
  const turn_of turn(&mote);
  {
    const auto x = sent();
    const acting_on its(x.from);
    note_arrival(message_kind::message, fan);
    note_arrival(message_kind::message, fan);
  }
  {
    const auto x = sent(message_kind::channel);
    note_loss(x.from, loss::channel_lost);
  }
  REQUIRE(ends.size() == 2);
  CHECK(ends[0].outcome == message_end::how::arrived);
  CHECK(ends[0].at == instant(3s));
  CHECK(ends[1].outcome == message_end::how::lost);
  CHECK(ends[1].cause == loss::channel_lost);
  CHECK(ends[1].kind == message_kind::channel);
  CHECK(ends[1].place == "mote/kitchen/fan");
  auto open = sent();
  ledger->finish();
  open = packet{0, provenance::none()};
  CHECK(ends.size() == 2);
  CHECK(tally(*ledger).in_transit() == 1);
}

TEST_CASE("threads close accounts of each other's messages", "[core][ledger]") {
  constexpr int count = 2000;
  account_ref::share_between_threads();
  const auto ledger = message_ledger::make();
  std::vector<packet> all;
  node mote("mote/kitchen/fan", *ledger);
  {
    const turn_of turn(&mote);
    for (int i = 0; i < count; ++i)
      all.push_back(sent());
  }
  const auto end = [&ledger](std::vector<packet> copies, const char* place, bool arrives) {
    node gateway(place, *ledger);
    const turn_of turn(&gateway);
    for (std::size_t i = 0; i < copies.size(); ++i) {
      const acting_on its(copies[i].from);
      if (arrives && i % 2 == 0)
        note_arrival(message_kind::message, fan);
      else
        note_loss(loss::queue_full);
      copies[i] = packet{0, provenance::none()};
    }
  };
  std::thread other(end, all, "gateway/kitchen", true);
  end(std::move(all), "sink/kitchen", false);
  other.join();
  CHECK(tally(*ledger).arrived == count / 2);
  CHECK(lost(tally(*ledger), loss::queue_full) == count / 2);
}

TEST_CASE("every cause has a name and a sentence of its own", "[core][ledger]") {
  for (std::size_t i = 0; i < loss_count; ++i) {
    const auto x = static_cast<loss>(i);
    CHECK(parse_loss(to_string(x)) == x);
    CHECK(meaning_of(x).ends_with('.'));
  }
  CHECK(!parse_loss("nothing"));
}
