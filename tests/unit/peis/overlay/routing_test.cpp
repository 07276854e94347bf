#include <string>

#include "peis/overlay/routing_table.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

constexpr link_id left{1};
constexpr link_id right{2};
constexpr peer_id far{30};

routing_table empty_table() {
  return {peer_id{1}, 111, 30};
}

routing_entry entry_of_far(std::int32_t seqno, std::uint8_t hops, std::int32_t magic = 7) {
  return {far, seqno, magic, hops, 1};
}

std::string kinds(const routing_changes& changes) {
  std::string text;
  for (const auto& x : changes)
    text += "almr"[static_cast<int>(x.what)];
  return text;
}

} // namespace

TEST_CASE("a way that maximises seqno minus hops is kept or taken", "[peis][RTE-06]") {
  const auto [seqno, hops, switches] = GENERATE(table<int, int, bool>({
      {10, 2, false}, // as good
      {11, 2, true},  // newer
      {10, 1, true},  // shorter
      {10, 3, false}, // longer
      {12, 3, true},  // longer but newer by more
  }));
  auto routes = empty_table();
  const routing_entry first[] = {entry_of_far(10, 2)};
  CHECK(kinds(routes.on_table(left, 2, first, instant{})) == "a");
  const routing_entry second[] = {entry_of_far(seqno, static_cast<std::uint8_t>(hops))};
  CHECK(routes.on_table(right, 2, second, instant{}).empty());
  CHECK(routes.way_to(far) == (switches ? right : left));
}

TEST_CASE("news over the link in use always count", "[peis][RTE-06]") {
  auto routes = empty_table();
  const routing_entry good[] = {entry_of_far(10, 1)};
  const routing_entry worse[] = {entry_of_far(9, 5)};
  static_cast<void>(routes.on_table(left, 1, good, instant{}));
  static_cast<void>(routes.on_table(left, 1, worse, instant{}));
  CHECK(routes.find(far)->hops == 6);
}

TEST_CASE("an absent entry loses the way or moves it", "[peis][RTE-06]") {
  auto routes = empty_table();
  const routing_entry entries[] = {entry_of_far(10, 1)};
  static_cast<void>(routes.on_table(left, 1, entries, instant{}));
  CHECK(kinds(routes.on_table(left, 1, {}, instant{})) == "l");
  CHECK(routes.find(far)->hops == 250);
  CHECK(!routes.way_to(far));
  CHECK(kinds(routes.on_table(left, 1, entries, instant{})) == "a");
  static_cast<void>(routes.on_table(right, 2, entries, instant{}));
  CHECK(kinds(routes.on_link_closed(left, instant{})) == "m");
  CHECK(routes.way_to(far) == right);
  CHECK(kinds(routes.on_link_closed(right, instant{})) == "l");
}

TEST_CASE("a lost host is outdated after three periods at most", "[peis][RTE-07]") {
  auto routes = empty_table();
  const routing_entry entries[] = {entry_of_far(10, 1)};
  static_cast<void>(routes.on_table(left, 1, entries, instant{}));
  static_cast<void>(routes.on_link_closed(left, instant{}));
  for (int i = 0; i < 2; ++i)
    CHECK(routes.age(instant{}).empty());
  CHECK(routes.age(instant{}) == std::vector<peer_id>{far});
}

TEST_CASE("a host of our kind that was lost is back when it gives a sign of life",
          "[peis][RTE-07]") {
  auto routes = empty_table();
  const routing_entry entries[] = {entry_of_far(10, 2)};
  const routing_entry newer[] = {entry_of_far(12, 4)};
  static_cast<void>(routes.on_table(left, 1, entries, instant{}));
  SECTION("of another kind: what is sent of it counts") {
    CHECK(kinds(routes.on_table(left, 1, {}, instant{})) == "l");
    CHECK(kinds(routes.on_table(right, 1, newer, instant{})) == "a");
    return;
  }
  routes.mark(far);
  CHECK(kinds(routes.on_table(left, 1, {}, instant{})) == "l");
  CHECK(kinds(routes.on_table(right, 1, newer, instant{})).empty()); // it may be dead all the same
  CHECK(!routes.way_to(far));
  CHECK(routes.offers_of(far) == std::vector{right});
  CHECK(routes.take_unsound().contains(far));
  CHECK(kinds(routes.on_table(right, 1, newer, instant{1s})).empty());
  CHECK(routes.take_unsound().empty()); // it is being asked
  SECTION("it does") {
    CHECK(kinds(routes.on_sign_of_life(far)) == "a");
    CHECK(routes.way_to(far) == right);
    CHECK(routes.find(far)->seqno == 12);
    CHECK(routes.take_unsound().empty());
    CHECK(!routes.first_loss());
  }
  SECTION("it does not") {
    CHECK(routes.unanswered(far, instant{}, instant{30s}).empty());
    CHECK(routes.offers_of(far).empty());
    CHECK(routes.on_sign_of_life(far).empty());
    CHECK(routes.on_table(left, 1, newer, instant{}).empty());
    CHECK(routes.offers_of(far).empty()); // the same again is no news
    const routing_entry newest[] = {entry_of_far(13, 4)};
    CHECK(routes.on_table(left, 1, newest, instant{}).empty());
    CHECK(routes.offers_of(far) == std::vector{left});
  }
  SECTION("it is a neighbour") {
    const routing_entry near[] = {entry_of_far(10, 0)};
    CHECK(kinds(routes.on_table(left, 1, near, instant{})) == "a");
  }
  SECTION("another incarnation needs no sign") {
    const routing_entry reborn[] = {entry_of_far(1, 2, 8)};
    CHECK(kinds(routes.on_table(left, 1, reborn, instant{})) == "a");
  }
}

TEST_CASE("a host that did not answer is lost since it was asked, and back with a sign of life",
          "[peis][RTE-07]") {
  auto routes = empty_table();
  const routing_entry entries[] = {entry_of_far(10, 2)};
  static_cast<void>(routes.on_table(left, 1, entries, instant{}));
  routes.mark(far);
  CHECK(kinds(routes.unanswered(far, instant{2s}, instant{40s})) == "l");
  CHECK(routes.first_loss() == instant{2s});
  CHECK(routes.on_table(right, 1, entries, instant{5s}).empty()); // as old
  CHECK(routes.offers_of(far).empty());
  const routing_entry newer[] = {entry_of_far(11, 4)};
  CHECK(routes.on_table(right, 1, newer, instant{5s}).empty());
  CHECK(kinds(routes.on_sign_of_life(far)) == "a");
  CHECK(!routes.first_loss());
}

TEST_CASE("a host that was lost while it was asked is lost since then", "[peis][RTE-07]") {
  auto routes = empty_table();
  const routing_entry entries[] = {entry_of_far(10, 2)};
  static_cast<void>(routes.on_table(left, 1, entries, instant{}));
  routes.mark(far);
  CHECK(kinds(routes.on_table(left, 1, {}, instant{3s})) == "l");
  CHECK(routes.first_loss() == instant{3s});
  CHECK(routes.unanswered(far, instant{2s}, instant{40s}).empty());
  CHECK(routes.first_loss() == instant{2s});
}

TEST_CASE("ways at the metric limit and lost ones count as absent", "[peis][RTE-03]") {
  auto routes = empty_table();
  const routing_entry entries[] = {entry_of_far(10, 28)};
  CHECK(routes.on_table(left, 2, entries, instant{}).empty());
  CHECK(kinds(routes.on_table(left, 1, entries, instant{})) == "a");
  const routing_entry lost[] = {entry_of_far(11, 250)};
  CHECK(kinds(routes.on_table(left, 1, lost, instant{})) == "l");
}

TEST_CASE("a way is not told to where it leads", "[peis][RTE-06]") {
  auto routes = empty_table();
  const routing_entry entries[] = {entry_of_far(10, 1)};
  static_cast<void>(routes.on_table(left, 1, entries, instant{}));
  CHECK(routes.table_for(left, 2).size() == 1); // ourselves
  CHECK(routes.table_for(right, 2).size() == 2);
}

TEST_CASE("a number of an earlier life is overtaken", "[peis][RTE-08]") {
  auto routes = empty_table();
  const routing_entry old[] = {{peer_id{1}, 500, 999, 2, 1}};
  static_cast<void>(routes.on_table(left, 1, old, instant{}));
  CHECK(routes.take_overtaken());
  CHECK(!routes.take_overtaken());
  CHECK(routes.next_seqno() == 501);
}

TEST_CASE("a dead incarnation is not taken up again, a new one is", "[peis][RTE-09]") {
  auto routes = empty_table();
  routes.bury(far, 7, instant{30s});
  const routing_entry old[] = {entry_of_far(10, 1, 7)};
  const routing_entry fresh[] = {entry_of_far(1, 1, 8)};
  CHECK(routes.on_table(left, 1, old, instant{29s}).empty());
  CHECK(kinds(routes.on_table(left, 1, fresh, instant{29s})) == "a");
  static_cast<void>(routes.on_table(left, 1, {}, instant{29s}));
  CHECK(kinds(routes.on_table(left, 1, old, instant{30s})) == "a"); // the grave has gone
}

TEST_CASE("another magic number is a restart", "[peis][RTE-08]") {
  auto routes = empty_table();
  const routing_entry old[] = {entry_of_far(10, 1, 7)};
  const routing_entry fresh[] = {entry_of_far(11, 1, 8)};
  static_cast<void>(routes.on_table(left, 1, old, instant{}));
  CHECK(kinds(routes.on_table(left, 1, fresh, instant{})) == "r");
}

} // namespace rubicon::peis
