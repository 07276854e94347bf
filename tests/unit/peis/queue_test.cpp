#include <string>

#include "peis/delivery/reassembly.hpp"
#include "peis/delivery/seen_ids.hpp"
#include "peis/link/id_source.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

outgoing_package numbered(std::int32_t id) {
  outgoing_package x;
  x.header.id = id;
  x.content = std::make_shared<const message_octets>();
  return x;
}

package_header fragment(std::int32_t source, std::uint16_t number, std::uint16_t count,
                        std::uint16_t length = data_max) {
  package_header x;
  x.source = peer_id{source};
  x.port = 20;
  x.seqid = 5;
  x.seqnum = number;
  x.seqlen = count;
  x.length = length;
  return x;
}

} // namespace

TEST_CASE("a lower class leaves only when all higher ones are empty", "[peis][P2P-02][API-03]") {
  outgoing_queue queue({10});
  queue.push(lane::bulk, numbered(5));
  queue.push(lane::normal, numbered(4));
  queue.push(lane::high, numbered(3));
  queue.push(lane::control, numbered(1));
  queue.push(lane::acknowledgements, numbered(2));
  queue.push(lane::control, numbered(1));
  std::string order;
  while (const auto x = queue.pop())
    order += std::to_string(x->header.id);
  CHECK(order == "112345");
}

TEST_CASE("a full class refuses, others do not", "[peis][P2P-03]") {
  random_stream rng(1);
  outgoing_queue queue({4});
  for (int i = 0; i < 4; ++i) {
    CHECK(queue.admission(lane::control, 1, 0, own_origin, rng) == cause::none);
    queue.push(lane::control, numbered(i + 1));
  }
  CHECK(queue.admission(lane::control, 1, 0, own_origin, rng) == cause::queue_full);
  CHECK(queue.admission(lane::normal, 4, 0, own_origin, rng) == cause::none);
  CHECK(queue.admission(lane::normal, 5, 0, own_origin, rng) == cause::queue_full);
}

TEST_CASE("early drop starts at half full and grows to certainty", "[peis][P2P-03]") {
  random_stream rng(7);
  outgoing_queue queue({100});
  const auto refused = [&] {
    int count = 0;
    for (int i = 0; i < 1000; ++i)
      count += queue.admission(lane::normal, 1, 0, own_origin, rng) == cause::early_drop ? 1 : 0;
    return count;
  };
  for (int i = 0; i < 50; ++i)
    queue.push(lane::high, numbered(1));
  CHECK(refused() == 0);
  CHECK(!queue.has_room(lane::normal));
  for (int i = 0; i < 25; ++i)
    queue.push(lane::normal, numbered(1));
  CHECK(refused() > 400);
  CHECK(refused() < 600);
  CHECK(queue.admission(lane::acknowledgements, 1, 0, own_origin, rng) ==
        cause::none); // above them
}

TEST_CASE("a message in two parts is read across the seam", "[peis]") {
  const message_octets x{payload(bytes{0, 1, 2}), payload(bytes{3, 4, 5, 6})};
  for (std::size_t offset = 0; offset <= 7; ++offset) {
    for (std::size_t count = 0; offset + count <= 7; ++count) {
      bytes out;
      x.append(offset, count, out);
      REQUIRE(out.size() == count);
      for (std::size_t i = 0; i < count; ++i)
        CHECK(out[i] == offset + i);
    }
  }
}

TEST_CASE("the queues of all links have a limit together, of which each may have a share",
          "[peis][P2P-02]") {
  constexpr std::size_t size = header_size + data_max;
  outgoing_package full;
  full.content = std::make_shared<const message_octets>(message_octets{bytes(data_max), {}});
  const auto memory = std::make_shared<queues_memory>(queues_memory{60 * size});
  std::vector<outgoing_queue> queues(3, outgoing_queue({1000}, memory));
  random_stream rng(1);
  const auto fill = [&](outgoing_queue& x) {
    while (x.admission(lane::normal, 1, size, link_id{1}, rng) == cause::none)
      x.push(lane::normal, full, link_id{1});
    return x.size();
  };
  CHECK(fill(queues[0]) == 30);
  CHECK(fill(queues[1]) == 15);
  CHECK(queues[2].has_room(lane::normal)); // there is always room for another
  queues[0].push(lane::control, full);
  while (queues[0].pop()) {
  }
  CHECK(memory->octets == 15 * size);
  CHECK(fill(queues[1]) == 30);
}

TEST_CASE("ids are remembered for as many as promised", "[peis][P2P-07]") {
  seen_ids seen(4096);
  for (std::int32_t id = 1; id <= 20000; ++id) {
    REQUIRE(seen.insert(peer_id{1}, id));
    REQUIRE(!seen.insert(peer_id{1}, id));
    if (id > 4096)
      REQUIRE(!seen.insert(peer_id{1}, id - 4090));
  }
  CHECK(seen.insert(peer_id{2}, 20000)); // of another source
  CHECK(seen.size() <= 4096);
  CHECK(seen.size() >= 4091);
}

TEST_CASE("a link that floods makes nobody forget what has come over others", "[peis][P2P-07]") {
  seen_ids seen(4096, random_stream(1));
  const link_id modest{1};
  const link_id busy{2};
  const link_id flooding{3};
  for (std::int32_t id = 1; id <= 100; ++id)
    REQUIRE(seen.insert(peer_id{1}, id, modest));
  for (std::int32_t id = 1; id <= 4000; ++id)
    REQUIRE(seen.insert(peer_id{2}, id, busy));
  for (std::int32_t id = 1; id <= 50000; ++id)
    REQUIRE(seen.insert(peer_id{3}, id, flooding));
  CHECK(seen.size() <= 4096);
  CHECK(seen.size() >= 4091);
  for (std::int32_t id = 1; id <= 100; ++id)
    CHECK(!seen.insert(peer_id{1}, id, flooding));
  for (std::int32_t id = 4000; id > 4000 - 1990; --id) // half of what the modest one leaves
    CHECK(!seen.insert(peer_id{2}, id, flooding));
  for (std::int32_t id = 50000; id > 50000 - 1990; --id)
    CHECK(!seen.insert(peer_id{3}, id, busy));
}

TEST_CASE("what links have brought is remembered when they are gone, as of one", "[peis][P2P-07]") {
  seen_ids seen(4096, random_stream(1));
  for (std::int32_t id = 1; id <= 4000; ++id) {
    const link_id fleeting{static_cast<std::uint64_t>(id)};
    REQUIRE(seen.insert(peer_id{1}, id, fleeting));
    seen.on_link_closed(fleeting);
  }
  CHECK(!seen.insert(peer_id{1}, 1, link_id{5000}));
  for (std::int32_t id = 1; id <= 2000; ++id)
    REQUIRE(seen.insert(peer_id{2}, id, link_id{5000}));
  for (std::int32_t id = 2001; id <= 4000; ++id)
    CHECK(!seen.insert(peer_id{1}, id, link_id{5000}));
  for (std::int32_t id = 1; id <= 2000; ++id)
    CHECK(!seen.insert(peer_id{2}, id, link_id{5000}));
}

TEST_CASE("no id comes again before all others have", "[peis][P2P-06]") {
  random_stream rng(1);
  id_source ids(rng);
  std::vector<bool> used(1U << 31);
  for (std::int64_t i = 1; i < 1'000'000; ++i) {
    const auto id = ids.next();
    REQUIRE(id > 0);
    REQUIRE(!used[static_cast<std::size_t>(id)]);
    used[static_cast<std::size_t>(id)] = true;
  }
  for (int i = 0; i < 40000; ++i) {
    const auto group = ids.next_group();
    CHECK(group >= 1);
    CHECK(group <= 32767);
  }
}

TEST_CASE("fragments of two sources with equal numbers do not mix", "[peis][P2P-04]") {
  reassembly assembly{reassembly_config{}};
  const bytes a(data_max, 1);
  const bytes b(data_max, 2);
  CHECK(!assembly.add(fragment(1, 0, 2), a, instant{}));
  CHECK(!assembly.add(fragment(2, 0, 2), b, instant{}));
  const auto whole = assembly.add(fragment(1, 1, 2, 1), bytes{1}, instant{});
  REQUIRE(whole);
  CHECK(*whole == bytes(data_max + 1, 1));
}

TEST_CASE("an incomplete message is discarded 10 s after its last fragment", "[peis][P2P-04]") {
  reassembly assembly{reassembly_config{}};
  const bytes data(data_max);
  CHECK(!assembly.add(fragment(1, 0, 3), data, instant{}));
  CHECK(!assembly.add(fragment(1, 1, 3), data, instant{4s}));
  CHECK(assembly.on_time(*assembly.deadline()) == 0);
  REQUIRE(assembly.deadline() == instant{14s});
  CHECK(assembly.on_time(instant{14s}) == 1);
  CHECK(assembly.size() == 0);
  CHECK(!assembly.deadline());
}

TEST_CASE("messages that are put together take of what all tables have in common",
          "[peis][P2P-04]") {
  const auto memory = std::make_shared<fair_share>(20 * data_max);
  reassembly assembly{reassembly_config{4, 16 * data_max, 10s}};
  assembly.use_memory(memory);
  const bytes data(data_max);
  const link_id one{1};
  memory->add(peer_id{7}, 12 * data_max);
  CHECK(!assembly.accepts(fragment(1, 4, 5), one)); // five of the eight that are left
  REQUIRE(assembly.accepts(fragment(1, 3, 4), one));
  CHECK(!assembly.add(fragment(1, 3, 4), data, instant{}, one));
  CHECK(memory->total() == 16 * data_max);
  CHECK(memory->of(peer_id{1}) == 0);
  CHECK(!memory->admits(peer_id{8}, 5 * data_max));
  CHECK(memory->admits(peer_id{8}, 3 * data_max));
  memory->remove(peer_id{7}, 12 * data_max);
  CHECK(assembly.accepts(fragment(2, 4, 5), link_id{2}));
  CHECK(assembly.on_time(instant{10s}) == 1);
  CHECK(memory->total() == 0);
}

TEST_CASE("reassembly is bounded in messages and octets", "[peis][P2P-04]") {
  reassembly assembly{reassembly_config{4, 16 * data_max, 10s}};
  const bytes data(data_max);
  const link_id one{1};
  const link_id other{2};
  CHECK(!assembly.accepts(fragment(1, 8, 9), one)); // would make room for nine of sixteen
  CHECK(assembly.accepts(fragment(1, 1, 9), one));
  CHECK(!assembly.add(fragment(1, 1, 9), data, instant{}, one));
  CHECK(assembly.octets() == 2 * data_max);
  CHECK(!assembly.accepts(fragment(1, 2, 8), one)); // another count
  CHECK(!assembly.add(fragment(2, 0, 9), data, instant{}, one));
  CHECK(!assembly.accepts(fragment(3, 0, 9), one)); // half of the messages are its own
  CHECK(assembly.accepts(fragment(3, 0, 9), other));
  CHECK(!assembly.add(fragment(3, 0, 9), data, instant{}, other));
  CHECK(!assembly.accepts(fragment(4, 0, 9), other)); // as many as are free
  CHECK(assembly.accepts(fragment(2, 1, 9), one));
  assembly.drop(peer_id{1});
  CHECK(assembly.accepts(fragment(4, 0, 9), one));
  assembly.drop(peer_id{2});
  assembly.drop(peer_id{3});
  CHECK(assembly.octets() == 0);
}

TEST_CASE("memory for a long message grows with what has come of it", "[peis][P2P-04]") {
  reassembly assembly{reassembly_config{}};
  const bytes data(data_max);
  for (std::uint16_t i = 0; i < 100; ++i) {
    CHECK(!assembly.add(fragment(1, i, 16384), data, instant{}));
    CHECK(assembly.octets() <= 2 * (i + 1U) * data_max);
  }
  for (std::uint16_t i = 0; i < 3; ++i)
    static_cast<void>(assembly.add(fragment(2, i, 3), data, instant{}));
  assembly.drop(peer_id{1});
  CHECK(assembly.octets() == 0);
}

TEST_CASE("an origin that floods a link leaves the others their turn", "[peis][P2P-03]") {
  random_stream rng(3);
  outgoing_queue queue({100});
  const link_id flooder{5};
  const link_id other{6};
  const auto offer = [&](link_id origin, std::int32_t id) {
    const auto why = queue.admission(lane::normal, 1, header_size, origin, rng);
    if (why == cause::none)
      queue.push(lane::normal, numbered(id), origin);
    return why;
  };
  for (int i = 0; i < 1000; ++i)
    static_cast<void>(offer(flooder, 1));
  CHECK(queue.depth(lane::normal) == 50); // as many as are free beside them
  for (int i = 0; i < 20; ++i)
    CHECK(offer(other, 2) == cause::none); // neither refused nor given up at random
  CHECK(offer(own_origin, 3) == cause::none);
  CHECK(queue.has_room(lane::normal));
  std::string order;
  for (int i = 0; i < 6; ++i)
    order += std::to_string(queue.pop()->header.id);
  CHECK(order == "123121");
}

TEST_CASE("a queue is bounded in octets", "[peis][P2P-03]") {
  random_stream rng(3);
  outgoing_queue queue({100, 10'000});
  const auto content =
      std::make_shared<const message_octets>(message_octets{payload(bytes(data_max)), {}});
  const auto size = header_size + data_max;
  std::size_t taken = 0;
  while (queue.admission(lane::normal, 1, size, own_origin, rng) == cause::none) {
    queue.push(lane::normal, {{}, content, 0});
    ++taken;
  }
  CHECK(taken == 9);
  CHECK(queue.octets() == 9 * size);
  CHECK(!queue.has_room(lane::bulk));
  CHECK(queue.admission(lane::control, 1, size, own_origin, rng) == cause::none); // has its own
  while (queue.pop()) {
  }
  CHECK(queue.octets() == 0);
}

} // namespace rubicon::peis
