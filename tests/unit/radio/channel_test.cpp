#include "core/account/message_ledger.hpp"
#include "core/codec.hpp"
#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::channel_with;
using test::radio_fixture;

namespace {

/// An actor as far as the account of messages sees it.
class node final : public provenance_source {
public:
  explicit node(message_ledger& ledger) : ledger_(&ledger) {}

  [[nodiscard]] std::uint64_t begin(std::string_view, std::uint64_t) override { return 0; }
  [[nodiscard]] message_ledger* ledger() override { return ledger_; }
  [[nodiscard]] std::string_view place() const override { return "air"; }
  [[nodiscard]] instant time() const override { return {}; }

private:
  message_ledger* ledger_;
};

/// Units of the first back-off of the first sender, given how many radios were added before.
duration first_backoff(std::uint64_t seed, int radios) {
  random_stream rng(seed);
  for (int i = 0; i < 2; ++i)
    static_cast<void>(rng.next()); // the links' and the noise's seeds
  for (int i = 0; i < radios; ++i)
    static_cast<void>(rng.below(256)); // their first sequence numbers
  return static_cast<int>(rng.below(8)) * 320us;
}

} // namespace

TEST_CASE("an acked exchange takes the standard's time to the microsecond",
          "[radio][channel][NET-15]") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    radio_fixture x({}, seed);
    const auto a = x.add(1, 0);
    const auto b = x.add(2, 10);
    x.send(a, 77, 2, 2); // 15 octets of PSDU
    x.run_until(instant(1s));
    const auto on_air = instant{} + first_backoff(seed, 2) + 128us + 192us;
    const auto frame_end = on_air + 672us;
    REQUIRE(x.log.size() == 2);
    CHECK(x.times_of<delivered>().front() == frame_end);
    CHECK(x.times_of<done>().front() == frame_end + 192us + 352us);
    const auto ended = x.all<done>().front();
    CHECK(ended.radio == a);
    CHECK(ended.token == 77);
    CHECK(ended.status == send_status::sent);
    CHECK(ended.transmissions == 1);
    CHECK(ended.arrived);
    CHECK(ended.last == copy_outcome::delivered);
    const auto got = x.all<delivered>().front();
    CHECK(got.to == b);
    CHECK(got.rssi_dbm == -70); // log distance: 40 dB, and 30 dB for a factor of 10
    CHECK(got.lqi == 110);
    CHECK(x.channel.energy(a, x.now).times.radio_transmit == 672us);
    CHECK(x.channel.energy(a, x.now).times.radio_receive == 352us);
    CHECK(x.channel.energy(b, x.now).times.radio_transmit == 352us);
    CHECK(x.channel.energy(b, x.now).times.radio_receive == 672us);
    CHECK(x.channel.counts().by_all().transmissions == 2);
    CHECK(x.channel.counts().by_all().acks == 1);
    CHECK(x.channel.counts().by_all().acks_received == 1);
    CHECK(x.channel.counts().by_all().copies.of(copy_outcome::delivered) == 2);
    CHECK_FALSE(x.channel.deadline() < instant(1h)); // batteries only
  }
}

TEST_CASE("a channel keeps no copy of a message whose frame has ended",
          "[radio][channel][ledger]") {
  const auto ledger = message_ledger::make();
  const mote_address fan{island_id(1), mote_id(1)};
  node air(*ledger);
  const turn_of turn(&air);
  radio_fixture x({}, 1);
  const auto a = x.add(1, 0);
  static_cast<void>(x.add(2, 10));
  {
    const acting_on its(begin_message(message_kind::message, fan, {fan.island, mote_id(2)}));
    x.send(a, 77, broadcast_mote.value, 2); // no ack takes the slot again
  }
  x.run_until(instant(1s));
  REQUIRE(x.all<delivered>().size() == 1);
  CHECK(ledger->of(fan, message_kind::message).in_transit() == 1);
  x.log.clear(); // what it has output
  CHECK(ledger->of(fan, message_kind::message).in_transit() == 0);
}

TEST_CASE("what is delivered is the frame as TinyOS writes it", "[radio][channel]") {
  radio_fixture x;
  const auto a = x.add(3, 0, 0x22);
  x.add(1, 10, 0x22);
  x.note(x.channel.send(a, {1, mote_id{1}, 6, bytes{0x00, 0x01}, true}, x.now));
  x.note(x.channel.send(a, {2, broadcast_mote, 9, bytes{}, true}, x.now));
  x.run_until(instant(1s));
  const auto all = x.all<delivered>();
  REQUIRE(all.size() == 2);
  const auto first = decode(all[0].psdu.view());
  REQUIRE(first);
  CHECK(to_hex(all[0].psdu.view().first(2)) == "6188");
  CHECK(to_hex(all[0].psdu.view().subspan(3, 10)) == "2200010003003f060001");
  CHECK(first->payload.data() == all[0].content.payload.data()); // a view, not a copy
  CHECK(all[0].content.source == mote_id{3});
  CHECK(all[0].content.am_type == 6);
  CHECK(to_hex(all[1].psdu.view().first(2)) == "4188"); // a broadcast asks for no ack
  CHECK(all[1].content.dsn == static_cast<std::uint8_t>(all[0].content.dsn + 1));
  CHECK(all[1].content.payload.empty());
}

TEST_CASE("a frame can say how long it waited for the air, anew with each transmission",
          "[radio][channel][CLK-01]") {
  radio_fixture x;
  const auto a = x.add(3, 0);
  const auto b = x.add(1, 10);
  request asked{1, mote_id{1}, 6, bytes{0xaa, 0, 0, 0, 5, 0xbb}, true};
  asked.age_at = 1;
  x.channel.set_loss(a, b, 1); // it is repeated
  x.channel.watch();
  x.note(x.channel.send(a, asked, x.now));
  x.run_until(instant(1s));
  const auto all = x.all<overheard>();
  CHECK(all.size() == 4);
  for (const auto& seen : all) {
    const auto frame = decode(seen.psdu.view());
    REQUIRE(frame);
    CHECK(frame->payload[0] == 0xaa);
    CHECK(frame->payload[5] == 0xbb);
    const auto age = byte_reader(frame->payload.subspan(1)).big<std::uint32_t>();
    CHECK(std::chrono::microseconds(age) == seen.begin + sfd_delay - instant{} + 5us);
  }
}

TEST_CASE("all receivers share one object", "[radio][channel]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  for (std::uint16_t i = 2; i < 6; ++i)
    x.add(i, i);
  x.send(a, 1, 0xffff, 10);
  x.run_until(instant(1s));
  const auto all = x.all<delivered>();
  REQUIRE(all.size() == 4);
  for (std::uint32_t i = 0; i < 4; ++i) {
    CHECK(all[i].to == radio_index{i + 1});
    CHECK(all[i].psdu.view().data() == all[0].psdu.view().data());
  }
  CHECK(x.all<done>().front().status == send_status::sent);
}

TEST_CASE("with loss 1 nothing crosses and a unicast frame is tried four times",
          "[radio][channel][GEN-03]") {
  radio_fixture x(channel_with([](auto& c) { c.loss = 1; }));
  const auto a = x.add(1, 0);
  x.add(2, 10);
  x.send(a, 1, 2, 28);
  x.send(a, 2, 0xffff, 28);
  x.run_until(instant(1s));
  CHECK(x.all<delivered>().empty());
  const auto ended = x.all<done>();
  REQUIRE(ended.size() == 2);
  CHECK(ended[0].status == send_status::no_ack);
  CHECK(ended[0].transmissions == 4);
  CHECK_FALSE(ended[0].arrived);
  CHECK(ended[0].last == copy_outcome::loss);
  CHECK(ended[1].last == copy_outcome::out_of_reach); // a broadcast has no destination
  CHECK(ended[1].status == send_status::sent);        // nobody promised more of a broadcast
  const auto radio_counters = x.channel.counts().by_all();
  CHECK(radio_counters.copies.sent == 5);
  CHECK(radio_counters.copies.of(copy_outcome::loss) == 5);
  CHECK(radio_counters.requests.failed.no_ack == 1);
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("loss 1 on one link leaves all other links alone", "[radio][channel][GEN-03]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  const auto c = x.add(3, 20);
  x.channel.set_loss(a, b, 1);
  for (std::uint64_t i = 0; i < 20; ++i) {
    x.send(a, i, 0xffff, 4);
    x.run_for(20ms);
    x.send(b, i, 0xffff, 4);
    x.run_for(20ms);
    x.send(c, i, 0xffff, 4);
    x.run_for(20ms);
  }
  CHECK(x.delivered_to(a) == 40);
  CHECK(x.delivered_to(b) == 20); // from c
  CHECK(x.delivered_to(c) == 40);
  CHECK(x.channel.counts().on_link(a, b).of(copy_outcome::loss) == 20);
}

TEST_CASE("a lost ack makes repeats that are acked but not delivered again", "[radio][channel]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  x.channel.set_loss(b, a, 1);
  x.send(a, 1, 2, 28);
  x.run_until(instant(1s));
  CHECK(x.delivered_to(b) == 1);
  CHECK(x.all<done>().front().status == send_status::no_ack);
  CHECK(x.all<done>().front().arrived);
  CHECK(x.all<done>().front().last == copy_outcome::duplicate);
  CHECK(x.channel.counts().by(b).copies.of(copy_outcome::duplicate) == 3);
  CHECK(x.channel.counts().by(b).acks == 4);
  CHECK(x.channel.counts().by(a).copies.of(copy_outcome::loss) == 4);
  CHECK(x.channel.counts().balanced());
  // The receiver reads every repeat, the sender has loaded its frame once.
  const auto service = find_platform("micaz")->service_time;
  CHECK(x.channel.energy(a, x.now).times.mcu_active == service);
  CHECK(x.channel.energy(b, x.now).times.mcu_active == 4 * service);
}

TEST_CASE("the same sequence number 256 frames later is a new frame", "[radio][channel]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  const auto c = x.add(3, 20);
  for (std::uint64_t i = 0; i < 257; ++i) {
    x.send(a, i, i % 256 == 0 ? 2 : 3, 4);
    x.run_for(20ms);
  }
  CHECK(x.delivered_to(b) == 2);
  CHECK(x.delivered_to(c) == 255);
}

TEST_CASE("a transmit queue takes its size and not one more", "[radio][channel]") {
  radio_fixture x(channel_with([](auto& c) { c.queue = 3; }));
  const auto a = x.add(1, 0);
  x.add(2, 10);
  for (std::uint64_t i = 0; i < 4; ++i)
    x.send(a, i, 2, 4);
  REQUIRE(x.all<done>().size() == 1); // at once
  CHECK(x.all<done>().front().token == 3);
  CHECK(x.all<done>().front().status == send_status::queue_full);
  CHECK(x.channel.counts().by(a).requests.open == 3);
  CHECK(x.channel.counts().balanced());
  x.run_until(instant(1s));
  const auto ended = x.all<done>();
  REQUIRE(ended.size() == 4);
  for (std::uint64_t i = 0; i < 3; ++i) {
    CHECK(ended[i + 1].token == i);
    CHECK(ended[i + 1].status == send_status::sent);
  }
  CHECK(x.channel.counts().by(a).requests ==
        request_counters{.requests = 4, .sent = 3, .failed = {.queue_full = 1}});
}

TEST_CASE("a frame for a mote that is not there is not acked", "[radio][channel]") {
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 1; }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  x.send(a, 1, 3, 4);
  x.run_until(instant(1s));
  CHECK(x.delivered_to(b) == 0);
  CHECK(x.all<done>().front().status == send_status::no_ack);
  CHECK(x.all<done>().front().transmissions == 2);
  CHECK(x.all<done>().front().last == copy_outcome::out_of_reach);
  CHECK(x.channel.counts().by(b).copies.of(copy_outcome::filtered) == 2);
}

TEST_CASE("a radio out of range receives and disturbs nothing", "[radio][channel][NET-15]") {
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 31);
  x.send(a, 1, 2, 4);
  x.run_until(instant(1s));
  CHECK(x.all<delivered>().empty());
  CHECK(x.channel.counts().by_all().copies.sent == 0);
  CHECK(x.channel.energy(b, x.now).times.radio_receive == 0ns);
  x.channel.move(b, {30, 0, 0});
  x.send(a, 2, 2, 4);
  x.run_until(instant(2s));
  CHECK(x.delivered_to(b) == 1);
  CHECK(x.neighbours(a) == std::vector{b});
}

TEST_CASE("a radio that moves away in the middle of a frame still gets it", "[radio][channel]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  const auto c = x.add(3, 500);
  x.send(a, 1, 0xffff, 100);
  while (x.channel.energy(b, x.now).times.radio_receive == 0ns)
    x.run_for(320us);
  x.channel.move(b, {500, 0, 0});
  x.channel.move(c, {10, 0, 0});
  x.run_until(instant(1s));
  CHECK(x.delivered_to(b) == 1);
  CHECK(x.delivered_to(c) == 0);
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("frames of other islands are received but never delivered",
          "[radio][channel][RTG-06][GEN-11]") {
  radio_fixture x;
  std::vector<radio_index> all;
  for (const auto pan : {std::uint16_t{1}, std::uint16_t{2}})
    for (std::uint16_t i = 1; i <= 4; ++i) // the same ids in both
      all.push_back(x.add(i, i, pan));
  random_stream rng(3);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const auto to = rng.chance(0.3) ? 0xffff : static_cast<std::uint16_t>(1 + rng.below(4));
    x.send(all[rng.below(all.size())], i, static_cast<std::uint16_t>(to), rng.below(30));
    x.run_for(rng.between(0ms, 10ms));
  }
  x.run_for(1s);
  std::size_t received = 0;
  for (const auto& y : x.all<delivered>()) {
    CHECK(y.content.pan == (y.to.value < 4 ? 1 : 2));
    ++received;
  }
  CHECK(received > 1000);
  const auto sum = x.channel.counts().by_all();
  auto parts = x.channel.counts().in_pan(1);
  CHECK(parts.copies.of(copy_outcome::filtered) > 100);
  CHECK(parts.balanced());
  CHECK(x.channel.counts().in_pan(2).balanced());
  parts += x.channel.counts().in_pan(2);
  CHECK(parts == sum);
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("a promiscuous radio overhears every PAN and acks only its own frames",
          "[radio][channel]") {
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0);
  radio_config config;
  config.address = mote_id{9};
  config.pan = 2;
  config.kind = find_platform("micaz");
  config.promiscuous = true;
  const auto sniffer = x.channel.add(config, x.now);
  x.send(a, 1, 9, 4); // same id, other PAN
  x.run_for(100ms);
  x.send(a, 2, 5, 4);
  x.run_for(100ms);
  CHECK(x.delivered_to(sniffer) == 2);
  CHECK(x.channel.counts().by(sniffer).acks == 0);
  CHECK(x.all<done>().front().status == send_status::no_ack);
}

TEST_CASE("a frame for others takes no receive slot and needs none", "[radio][channel]") {
  auto slow = *find_platform("micaz");
  slow.service_time = 10s;
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0);
  const auto full = x.add(2, 10, 1, &slow);
  for (int i = 0; i < 3; ++i)
    x.send(a, 1, 9, 4); // takes none
  for (int i = 0; i < 4; ++i)
    x.send(a, 1, 2, 4);
  x.run_for(1s);
  x.send(a, 1, 9, 4); // needs none
  x.run_for(1s);
  const auto copies = x.channel.counts().by(full).copies;
  CHECK(copies.of(copy_outcome::filtered) == 4);
  CHECK(copies.of(copy_outcome::delivered) == 3);
  CHECK(copies.of(copy_outcome::overflow) == 1);
}

TEST_CASE("a late wake-up changes nothing but its own time", "[radio][channel]") {
  radio_fixture punctual({}, 9);
  radio_fixture late({}, 9);
  for (auto* x : {&punctual, &late}) {
    const auto a = x->add(1, 0);
    x->add(2, 10);
    x->send(a, 1, 2, 28);
    x->send(a, 2, 2, 28);
  }
  punctual.run_until(instant(1s));
  late.now = instant(1s);
  late.note(late.channel.on_time(late.now));
  REQUIRE(late.log.size() == punctual.log.size());
  for (std::size_t i = 0; i < late.log.size(); ++i)
    CHECK(late.log[i].what.index() == punctual.log[i].what.index());
  const radio_index a{0};
  CHECK(late.channel.counts().by_all() == punctual.channel.counts().by_all());
  CHECK(late.channel.energy(a, late.now).times == punctual.channel.energy(a, late.now).times);
}
