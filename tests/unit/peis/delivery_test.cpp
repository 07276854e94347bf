#include <vector>

#include "peis/delivery/delivery.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

constexpr peer_id there{9};

reliable_message message_of(std::size_t size, priority service = priority::normal,
                            std::uint64_t request = 1) {
  return {peer_id{1},
          there,
          20,
          service,
          request_id{request},
          std::make_shared<const message_octets>(message_octets{payload(bytes(size)), {}})};
}

} // namespace

TEST_CASE("an unacknowledged package is sent at 0, T, 3T, 6T, 10T, 15T, 21T and fails at 28T",
          "[peis][ACK-02][ACK-03][ACK-04]") {
  random_stream rng(1);
  id_source numbers(rng);
  delivery reliable{delivery_config{}};
  REQUIRE(reliable.add(message_of(10), numbers));
  auto package = reliable.next(there, numbers)->second;
  reliable.on_transmitted(package.header.ack_id, instant{});
  std::vector<int> sent_at{0};
  std::optional<instant> failed_at;
  auto last_id = package.header.id;
  while (const auto deadline = reliable.deadline()) {
    const auto due = reliable.take_due(*deadline, numbers);
    REQUIRE(due);
    if (due->failed) {
      failed_at = deadline;
      CHECK(due->failed->request == request_id{1});
      continue;
    }
    sent_at.push_back(static_cast<int>((*deadline - instant{}) / 400ms));
    CHECK(due->again->header.ack_id == package.header.ack_id);
    CHECK(due->again->header.id != last_id);
    last_id = due->again->header.id;
    reliable.on_transmitted(due->ack_id, *deadline);
  }
  CHECK(sent_at == std::vector<int>{0, 1, 3, 6, 10, 15, 21});
  CHECK(failed_at == instant{11200ms});
  CHECK(reliable.in_flight() == 0); // ACK-01
}

TEST_CASE("a long message succeeds when all its fragments have, and once", "[peis][ACK-07]") {
  random_stream rng(2);
  id_source numbers(rng);
  delivery reliable{delivery_config{}};
  REQUIRE(reliable.add(message_of(3000, priority::bulk), numbers));
  std::vector<std::int32_t> ids;
  while (const auto x = reliable.next(there, numbers)) {
    CHECK(x->first == lane::bulk);
    CHECK(x->second.header.seqlen == 3);
    CHECK((x->second.header.flags & package_flag::bulk) != 0);
    ids.push_back(x->second.header.ack_id);
  }
  REQUIRE(ids.size() == 3);
  CHECK(!reliable.acknowledge(ids[2])->finished);
  CHECK(!reliable.acknowledge(ids[0])->finished);
  CHECK(!reliable.acknowledge(ids[0])); // twice
  CHECK(reliable.acknowledge(ids[1])->finished);
}

TEST_CASE("one lost fragment fails the whole message once", "[peis][ACK-07]") {
  random_stream rng(3);
  id_source numbers(rng);
  delivery reliable{delivery_config{}};
  REQUIRE(reliable.add(message_of(5000, priority::bulk), numbers));
  std::vector<std::int32_t> ids;
  while (const auto x = reliable.next(there, numbers)) {
    ids.push_back(x->second.header.ack_id);
    reliable.on_transmitted(ids.back(), instant{});
  }
  for (std::size_t i = 1; i + 1 < ids.size(); ++i)
    CHECK(!reliable.acknowledge(ids[i])->finished);
  int failures = 0;
  while (const auto deadline = reliable.deadline()) {
    const auto due = reliable.take_due(*deadline, numbers);
    failures += due->failed ? 1 : 0;
    if (!due->failed)
      reliable.on_transmitted(due->ack_id, *deadline);
  }
  CHECK(failures == 1);
  CHECK(reliable.in_flight() == 0);
}

TEST_CASE("at most 256 packages are in flight to a destination, and bulk leaves room",
          "[peis][P2P-05][API-03]") {
  random_stream rng(4);
  id_source numbers(rng);
  delivery reliable{delivery_config{}};
  REQUIRE(reliable.add(message_of(1 << 20, priority::bulk), numbers));
  std::size_t bulk = 0;
  while (reliable.next(there, numbers))
    ++bulk;
  CHECK(bulk == 224);
  for (int i = 0; i < 50; ++i)
    REQUIRE(reliable.add(message_of(10), numbers));
  std::size_t normal = 0;
  while (const auto x = reliable.next(there, numbers)) {
    CHECK(x->first == lane::normal);
    ++normal;
  }
  CHECK(bulk + normal == 256);
}

TEST_CASE("messages that cannot begin wait up to a limit", "[peis][P2P-03]") {
  random_stream rng(5);
  id_source numbers(rng);
  delivery reliable{delivery_config{.window = {1, 2048}, .waiting_max = 3}};
  for (int i = 0; i < 3; ++i)
    CHECK(reliable.add(message_of(1), numbers));
  CHECK(!reliable.add(message_of(1), numbers));
  CHECK(reliable.next(there, numbers));
  CHECK(reliable.add(message_of(1), numbers));
  CHECK(reliable.fail_all(there).size() == 4);
  CHECK(!reliable.next_lane(there));
}

TEST_CASE("long messages that cannot begin wait up to a limit of octets", "[peis][P2P-03]") {
  random_stream rng(5);
  id_source numbers(rng);
  delivery reliable{delivery_config{.window = {1, 2048}, .waiting_octets_max = 1000}};
  CHECK(reliable.add(message_of(2000), numbers)); // alone, any length
  CHECK(!reliable.add(message_of(1), numbers));
  while (const auto x = reliable.next(there, numbers))
    static_cast<void>(reliable.acknowledge(x->second.header.ack_id));
  CHECK(reliable.add(message_of(600), numbers));
  CHECK(!reliable.add(message_of(401), numbers));
  CHECK(reliable.add(message_of(400), numbers));
}

TEST_CASE("an acknowledged package wakes nobody", "[peis][ACK-02]") {
  random_stream rng(7);
  id_source numbers(rng);
  delivery reliable{delivery_config{}};
  for (int i = 0; i < 2; ++i)
    REQUIRE(reliable.add(message_of(1), numbers));
  const auto first = reliable.next(there, numbers)->second.header.ack_id;
  const auto second = reliable.next(there, numbers)->second.header.ack_id;
  reliable.on_transmitted(first, instant{});
  reliable.on_transmitted(second, instant{10ms});
  static_cast<void>(reliable.acknowledge(first));
  CHECK(reliable.deadline() == instant{410ms});
  static_cast<void>(reliable.acknowledge(second));
  CHECK(!reliable.deadline());
}

TEST_CASE("nothing leaves that is too far ahead of what is not acknowledged", "[peis][ACK-08]") {
  random_stream rng(6);
  id_source numbers(rng);
  delivery reliable({.window = {256, 50}});
  std::optional<std::int32_t> oldest;
  std::size_t left = 0;
  for (int i = 0; i < 100; ++i)
    REQUIRE(reliable.add(message_of(1), numbers));
  while (const auto x = reliable.next(there, numbers)) {
    ++left;
    if (!oldest)
      oldest = x->second.header.ack_id;
    else
      static_cast<void>(reliable.acknowledge(x->second.header.ack_id));
  }
  CHECK(left == 50);
  static_cast<void>(reliable.acknowledge(*oldest));
  CHECK(reliable.next(there, numbers));
}

TEST_CASE("a long message of which only a part was taken is sent anew, under new numbers",
          "[peis][ACK-07]") {
  const bool begun_in_full = GENERATE(false, true);
  random_stream rng(5);
  id_source numbers(rng);
  delivery_config config;
  config.tries_max = 2;
  config.window = {4, 100};
  delivery reliable{config};
  REQUIRE(reliable.add(message_of(begun_in_full ? 3000 : 9000, priority::bulk), numbers));
  REQUIRE(reliable.add(message_of(10, priority::high, 2), numbers));
  std::vector<package_header> first;
  while (const auto x = reliable.next(there, numbers))
    first.push_back(x->second.header);
  REQUIRE(first.size() == 4);                            // the short one, and three fragments
  CHECK(reliable.begin_anew(there, numbers).begun == 0); // nothing was taken
  reliable.on_transmitted(first[1].ack_id, instant{});
  CHECK(!reliable.acknowledge(first[2].ack_id)->finished);
  CHECK(reliable.destination_of(first[3].ack_id) == there);
  CHECK(reliable.begin_anew(there, numbers).begun == 1);
  CHECK(!reliable.destination_of(first[3].ack_id));
  CHECK(!reliable.acknowledge(first[3].ack_id)); // of the first try
  CHECK(reliable.wanted(first[0].ack_id));       // the short message is as it was
  std::vector<package_header> second;
  while (const auto x = reliable.next(there, numbers))
    second.push_back(x->second.header);
  REQUIRE(second.size() == 3);
  CHECK(second[0].seqnum == 0);
  CHECK(second[0].seqid != first[1].seqid);
  if (begun_in_full) {
    CHECK(!reliable.acknowledge(second[0].ack_id)->finished);
    CHECK(!reliable.acknowledge(second[1].ack_id)->finished);
    SECTION("it succeeds") {
      CHECK(reliable.acknowledge(second[2].ack_id)->finished);
    }
  } else {
    CHECK(!reliable.acknowledge(second[0].ack_id)->finished);
  }
  SECTION("or fails when it was tried too often") {
    const auto ended = reliable.begin_anew(there, numbers);
    CHECK(ended.begun == 0);
    REQUIRE(ended.failed.size() == 1);
    CHECK(ended.failed[0].request == request_id{1});
    CHECK(reliable.in_flight() == 1);
  }
}

TEST_CASE("a long message that has paused for longer than its receiver waits is sent anew",
          "[peis][ACK-07]") {
  random_stream rng(6);
  id_source numbers(rng);
  delivery reliable{delivery_config{}};
  REQUIRE(reliable.add(message_of(3000, priority::bulk), numbers));
  std::vector<std::int32_t> ids;
  while (const auto x = reliable.next(there, numbers))
    ids.push_back(x->second.header.ack_id);
  reliable.on_transmitted(ids[0], instant{});
  reliable.on_transmitted(ids[1], instant{7s});
  CHECK(reliable.take_stale().empty());
  reliable.on_transmitted(ids[2], instant{17s});
  CHECK(reliable.take_stale() == std::set<peer_id>{there});
  CHECK(reliable.take_stale().empty());
  CHECK(reliable.begin_anew(there, numbers).begun == 1);
  CHECK(!reliable.acknowledge(ids[2]));
}

} // namespace rubicon::peis
