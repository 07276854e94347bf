// What a session over UDP is made of: the parts that have left, and those that have come.
#include "peis/udp/udp_receiver.hpp"
#include "peis/udp/udp_send_window.hpp"
#include "support/catch.hpp"

namespace rubicon::peis::udp_parts {
namespace {

using outcome = udp_receiver::outcome;
using state = udp_send_window::state;
using news = udp_send_window::news;

constexpr duration lost_after = 30ms;

instant at(duration x) {
  return instant(x);
}

/// @param content outlives the segment
udp_segment part(std::uint64_t sequence, std::uint32_t number, byte_view content) {
  udp_segment x;
  x.sequence = sequence;
  x.number = number;
  x.content = content;
  return x;
}

udp_segment report_of(udp_receiver& x) {
  udp_segment out;
  x.report_in(out);
  return out;
}

udp_segment report(std::uint64_t expected, std::uint32_t newest, std::uint32_t count,
                   byte_view bitmap = {}) {
  udp_segment x;
  x.expected = expected;
  x.newest = newest;
  x.count = count;
  x.content = bitmap;
  return x;
}

} // namespace

TEST_CASE("a receiver of UDP puts parts in order, and reports those behind a gap",
          "[peis][UDP-01]") {
  udp_receiver x(8);
  const bytes a{'a'};
  const bytes b{'b'};
  const bytes c{'c'};
  CHECK(!x.is_report_due());
  CHECK(x.on_part(part(1, 1, b)) == outcome::taken);
  CHECK(x.on_part(part(3, 2, c)) == outcome::taken);
  CHECK(x.on_part(part(1, 3, b)) == outcome::repeated);
  CHECK(!x.has_octets());
  CHECK(x.early() == 2);
  CHECK(x.bitmap() == bytes{0xa0});
  CHECK(x.is_report_due());
  x.note_reported(false);
  CHECK(x.is_report_due()); // without the bitmap
  x.note_reported(true);
  CHECK(!x.is_report_due());
  CHECK(x.on_part(part(0, 4, a)) == outcome::taken);
  CHECK(x.take({}) == bytes{'a', 'b'});
  CHECK(x.on_part(part(0, 5, a)) == outcome::repeated);
  const auto said = report_of(x);
  CHECK(said.expected == 2);
  CHECK(said.newest == 5);
  CHECK(said.count == 5);
  CHECK(said.credit == 8);
  CHECK(x.early() == 1);
}

TEST_CASE("a receiver of UDP keeps no part beyond its window, and no more than its owner takes",
          "[peis][UDP-01]") {
  udp_receiver x(2);
  const bytes whole(udp_content_max, 'x');
  CHECK(x.on_part(part(1, 1, whole)) == outcome::taken);
  CHECK(x.on_part(part(2, 2, whole)) == outcome::out_of_window);
  std::uint64_t sequence = 0;
  while (x.on_part(part(sequence, 3, whole)) != outcome::out_of_window)
    ++sequence;
  CHECK(sequence == 2 + 16); // credit, and those that ask for it
  CHECK(report_of(x).credit == 0);
  x.note_reported(true);
  CHECK(x.take({}).size() == sequence * udp_content_max);
  CHECK(x.is_report_due()); // there is room again
  CHECK(report_of(x).credit == 2);
}

TEST_CASE("a part that is overtaken for long is lost, and leaves under another number",
          "[peis][UDP-01]") {
  udp_send_window x;
  for (int i = 0; i < 3; ++i)
    x.add(bytes(10, 'x'));
  CHECK(x.lost() == 3); // none has left
  for (std::uint64_t i = 0; i < 3; ++i) {
    const auto leaves = x.transmit(i, at(1ms));
    CHECK(leaves.number == i + 1);
    CHECK(!leaves.is_repeated);
  }
  CHECK(x.under_way() == 3);
  const bytes second_behind{0x40}; // part 2
  const auto came = report(0, 3, 1, second_behind);
  REQUIRE(x.is_possible(came));
  CHECK(x.on_report(came) == news::newer);
  const auto arrived = x.acknowledge(came, at(11ms));
  CHECK(arrived.octets == 10);
  CHECK(arrived.round_trip == 10ms);
  CHECK(x.acknowledge(came, at(12ms)).octets == 0);
  x.find_losses(at(11ms), lost_after);
  CHECK(x.deadline() == at(31ms));
  CHECK(x.lost() == 0);
  x.find_losses(at(31ms), lost_after);
  CHECK(x.lost() == 2);
  CHECK(!x.deadline());
  CHECK(x.state_of(0) == state::lost);
  CHECK(x.state_of(2) == state::arrived);
  const auto again = x.transmit(0, at(31ms));
  CHECK(again.number == 4);
  CHECK(again.is_repeated);
  const auto all = report(3, 4, 2);
  REQUIRE(x.is_possible(all));
  CHECK(x.on_report(all) == news::newer);
  CHECK(x.acknowledge(all, at(40ms)).octets == 20);
  CHECK(x.size() == 0);
  CHECK(x.under_way() == 0);
  CHECK(x.lost() == 0);
}

TEST_CASE("a report that is impossible, old or equal is recognised", "[peis][UDP-01]") {
  udp_send_window x;
  x.add(bytes{'a'});
  static_cast<void>(x.transmit(0, at(0ms)));
  static_cast<void>(x.transmit(0, at(1ms)));
  CHECK(!x.is_possible(report(2, 1, 1)));
  CHECK(!x.is_possible(report(1, 3, 1)));
  CHECK(x.on_report(report(0, 0, 0)) == news::none);
  CHECK(x.on_report(report(0, 2, 1)) == news::newer);
  CHECK(x.on_report(report(0, 2, 2)) == news::same);
  CHECK(x.on_report(report(0, 1, 1)) == news::none);
  CHECK(x.newest() == 2);
  CHECK(x.count() == 2);
}

} // namespace rubicon::peis::udp_parts
