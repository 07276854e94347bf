#include "core/numbers/random.hpp"
#include "smepp/messages.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::smepp;

namespace {

group_time at_us(std::int64_t us) {
  return group_time(std::chrono::microseconds(us));
}

constexpr tag some_tag{1, 2, 3, 4, 5, 6, 7, 8};

key_share some_share() {
  key_share x{};
  x.fill(0xdd);
  return x;
}

wrapped_keys some_keys() {
  wrapped_keys x{{0x0102, mote_id{3}}, 0x050607, {}, some_tag};
  x.octets.fill(0xee);
  return x;
}

/// Each message with all its fields at their largest.
std::vector<message> fullest() {
  const member who{{mote_id{mote_id_max}, 0xffffffff}, 0xffff, false, some_tag};
  auto gone = who;
  gone.has_left = true;
  const subscription_id id{mote_id{mote_id_max}, 255};
  return {
      discover{0xffffffff, true, true, some_tag, std::string(group_description::name_max, 'n')},
      answer{1, group_id{2}, true, true, 3, 5000, 100, group_time_max, some_tag,
             bytes(group_description::name_max, 0xff)},
      join{group_id{1}, 2},
      join_challenge{group_id{1}, 2, some_tag},
      join_proof{group_id{1}, 2, some_tag, 0xffffffff, true, some_share(), some_share(), some_tag},
      join_accept{group_id{1}, 2, some_share(), some_keys(), 4, 5, at_us(6)},
      join_refuse{group_id{1}, 2, failure::group_full, some_tag},
      member_joined{who},
      member_left{gone},
      member_list{std::vector<member>(member_list::count_max, gone)},
      subscribe{id, 1, 2, at_us(3), at_us(4), 5, std::string(event_name_max, 'e'), true},
      unsubscribe{id, at_us(1)},
      event{id, mote_id{4}, 5, 6, sender_proof{0xffff'ffff'ffff, some_tag},
            bytes(event_value_max, 0xff)},
      sync_stamp{1, group_time_max, at_us(2), mote_id{3}, 4, 5, 6, {7, mote_id{8}}},
      key_refresh{some_keys()},
      challenge{1},
      proof{2}};
}

/// And with those left out that can be.
std::vector<message> smallest() {
  const subscription_id id{mote_id{1}, 1};
  return {discover{},
          discover{1, false, std::nullopt, std::nullopt, ""},
          answer{1, group_id{2}, false, false, 3, 0, 0, at_us(0), {}, bytes{'n'}},
          answer{1, group_id{2}, true, false, 3, 0, 0, at_us(0), some_tag, bytes{'n'}},
          member_list{{member{{mote_id{1}, 0}, 0, false}}},
          subscribe{id, 1, 2, at_us(3), at_us(4), 5, "e", false},
          event{id, mote_id{4}, 5, 6, std::nullopt, {}},
          sync_stamp{1, std::nullopt, at_us(2), mote_id{3}, 4, 5, 6, {7, mote_id{8}}}};
}

std::string refusal_of(byte_view octets) {
  const auto x = decode(octets);
  return x ? "none" : std::string(to_string(x.error()));
}

} // namespace

TEST_CASE("what peers say fits a frame and is understood", "[smepp][SMP-28]") {
  CHECK(message_max == 94);
  std::size_t kind = 0;
  for (const auto& each : fullest()) {
    CHECK(each.index() == kind++);
    const auto octets = encode(each);
    CHECK(octets.size() <= message_max);
    const auto again = decode(octets);
    REQUIRE(again);
    CHECK(*again == each);
    CHECK(is_network_level(each) == (octets[0] < 0x10));
    for (std::size_t size = 0; size < octets.size(); ++size) {
      const auto cut = decode(byte_view(octets).first(size));
      CHECK((!cut || std::holds_alternative<event>(each))); // an event's value may be shorter
    }
    auto longer = octets;
    longer.push_back(0);
    CHECK_FALSE(decode(longer));
  }
  CHECK(kind == std::variant_size_v<message>);
  for (const auto& each : smallest()) {
    const auto again = decode(encode(each));
    REQUIRE(again);
    CHECK(*again == each);
  }
}

TEST_CASE("messages lie on the wire as they are described", "[smepp][SMP-28]") {
  CHECK(to_hex(encode(join{group_id{0x0102}, 0x03040506})) == "03010203040506");
  CHECK(to_hex(encode(event{
            {mote_id{0x0102}, 3}, mote_id{0x0405}, 0x0607, 8, std::nullopt, bytes{0xaa, 0xbb}})) ==
        "16"
        "0102"
        "03"
        "0405"
        "0607"
        "08"
        "00"
        "aabb");
  CHECK(to_hex(encode(subscribe{{mote_id{1}, 2}, 3, 4, at_us(5), at_us(6), 7, "light", true})) ==
        "14"
        "0001"
        "02"
        "0003"
        "04"
        "000000000005"
        "000000000006"
        "00000007"
        "05"
        "6c69676874");
  CHECK(to_hex(encode(sync_stamp{1, at_us(2), at_us(3), mote_id{4}, 5, 6, 7, {8, mote_id{9}}})) ==
        "17"
        "0001"
        "01"
        "000000000002"
        "000000000003"
        "0004"
        "0005"
        "06"
        "0007"
        "0008"
        "0009");
}

TEST_CASE("what no peer would say is refused with a reason", "[smepp][SMP-28]") {
  CHECK(refusal_of({}) == to_string(errc::truncated));
  CHECK(refusal_of(bytes{0x00}) == to_string(errc::unsupported));
  CHECK(refusal_of(bytes{0x08}) == to_string(errc::unsupported));
  CHECK(refusal_of(bytes{0x1b}) == to_string(errc::unsupported));
  CHECK(refusal_of(bytes{0x19, 0, 0, 0}) == to_string(errc::truncated));
  CHECK(refusal_of(bytes(10, 0x19)) == to_string(errc::too_long));
  CHECK(refusal_of(*from_hex("03000000000000")) == to_string(errc::bad_value));
  const std::string mac(16, '0');
  CHECK(refusal_of(*from_hex("07"
                             "0001"
                             "00000000"
                             "09" +
                             mac)) == to_string(errc::bad_value));
  CHECK(refusal_of(*from_hex("12"
                             "00")) == to_string(errc::bad_value)); // an empty list
  CHECK(refusal_of(*from_hex("12"
                             "ff")) == to_string(errc::bad_value)); // a longest one
  CHECK(refusal_of(*from_hex("10"
                             "0000"
                             "00000000"
                             "0000"
                             "00" +
                             mac)) == to_string(errc::bad_value));
  CHECK(refusal_of(*from_hex("10"
                             "0001"
                             "00000000"
                             "0000"
                             "01" +
                             mac)) == to_string(errc::bad_value));
  CHECK(refusal_of(*from_hex("15"
                             "0001"
                             "00"
                             "000000000000")) == to_string(errc::bad_value));
}

TEST_CASE("octets of any kind do not upset the reader of messages", "[smepp][SMP-28]") {
  random_stream rng(7);
  auto seeds = fullest();
  for (const auto& x : smallest())
    seeds.push_back(x);
  unsigned understood = 0;
  for (int i = 0; i < 60'000; ++i) {
    bytes octets;
    if (rng.chance(0.5)) {
      octets = encode(seeds[rng.below(seeds.size())]);
      for (auto edits = rng.below(4); edits > 0; --edits)
        octets[rng.below(octets.size())] = static_cast<std::uint8_t>(rng.next());
      octets.resize(rng.chance(0.8) ? octets.size() : rng.below(octets.size() + 5));
    } else {
      octets.resize(rng.below(message_max + 10));
      for (auto& each : octets)
        each = static_cast<std::uint8_t>(rng.next());
      if (!octets.empty())
        octets[0] = static_cast<std::uint8_t>(rng.below(0x1d));
    }
    const auto x = decode(octets);
    if (!x)
      continue;
    ++understood;
    REQUIRE(encode(*x) == octets);
  }
  CHECK(understood > 5000);
}
