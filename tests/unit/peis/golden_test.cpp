// Every message kind against octets of real kernels, both ways.
#include <string>
#include <utility>
#include <vector>

#include "core/codec.hpp"
#include "peis/delivery/reassembly.hpp"
#include "peis/link/link.hpp"
#include "peis/space/tuple_space.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/wire/acknowledgement.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/host_query.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/package.hpp"
#include "peis/wire/routing_page.hpp"
#include "support/catch.hpp"
#include "unit/peis/capture.hpp"

namespace rubicon::peis {
namespace {

using test::capture;

struct captured {
  package_header header;
  bytes data;
};

std::vector<captured> packages(const std::string& name) {
  const auto stream = capture(name);
  stream_decoder decoder;
  decoder.feed(stream);
  std::vector<captured> all;
  while (const auto x = decoder.next())
    all.push_back({x->header, to_bytes(x->data)});
  REQUIRE(!decoder.broken());
  return all;
}

captured only(const std::string& name) {
  auto all = packages(name);
  REQUIRE(all.size() == 1);
  return all.front();
}

/// Octets that hold old memory of the real kernel are cleared on both sides.
using ranges = std::vector<std::pair<std::size_t, std::size_t>>; // offset, size

std::string without(bytes octets, const ranges& garbage) {
  for (const auto& [offset, size] : garbage) {
    for (std::size_t i = offset; i < offset + size && i < octets.size(); ++i)
      octets[i] = 0;
  }
  return to_hex(octets);
}

/// Garbage of a tuple record that starts at `base` and whose key has this length.
ranges record_garbage(std::size_t base, std::size_t key_length) {
  return {
      {base + 37, 3}, {base + 48, 36}, {base + 84 + key_length, 128 - key_length}, {base + 220, 4}};
}

} // namespace

TEST_CASE("headers of all captured packages decode and encode back", "[peis][P2P-06]") {
  const auto file =
      GENERATE(as<std::string>{}, "acks-many", "acks-one", "append-request", "dead-host-exit",
               "dead-host-reborn", "hostinfo-broadcast", "hostinfo-link", "push-appended",
               "push-fragments", "query-host", "routing-two-pages", "set-remote",
               "subscribe-forwarded", "timesync-master", "trace", "unsubscribe-any-owner");
  const auto stream = capture(file);
  std::size_t at = 0;
  for (const auto& x : packages(file)) {
    CHECK(is_legal(x.header));
    bytes again;
    encode(x.header, again);
    REQUIRE(again.size() == header_size);
    CHECK(without(again, {{38, 2}}) ==
          without(to_bytes(byte_view(stream).subspan(at, header_size)), {{38, 2}}));
    at += header_size + x.header.length;
  }
  CHECK(at == stream.size());
}

TEST_CASE("a package header has the fields of the capture", "[peis][P2P-06]") {
  const auto x = only("push-first-value").header;
  CHECK(x.id == 563130337);
  CHECK(x.counter == 3);
  CHECK(x.ack_id == 1684527853);
  CHECK(x.reliable());
  CHECK(x.type == package_type::direct);
  CHECK(x.hops == 1);
  CHECK(x.source == peer_id{10});
  CHECK(x.destination == peer_id{20});
  CHECK(x.port == port::push);
  CHECK(x.length == 240);
}

TEST_CASE("a forwarded package differs in counter and hops only", "[peis][P2P-01]") {
  auto all = packages("subscribe-forwarded");
  REQUIRE(all.size() == 2);
  CHECK(all[1].header.hops == all[0].header.hops + 1);
  all[1].header.hops = all[0].header.hops;
  all[1].header.counter = all[0].header.counter;
  CHECK(all[0].header == all[1].header);
}

TEST_CASE("the connect request of a real kernel decodes and encodes back", "[peis][LNK-06]") {
  const auto octets = capture("connect-from-real");
  const auto x = decode_connect_request(octets);
  REQUIRE(x);
  CHECK(*x == connect_request{500, peer_id{20}, connect_request::for_merge, "default"});
  CHECK(encode(*x) == octets); // zero filled by the real kernel too
}

TEST_CASE("host records of real kernels decode and encode back", "[peis][KH-03]") {
  const auto [file, id, cached] =
      GENERATE(table<std::string, int, bool>({{"hostinfo-link", 20, false},
                                              {"hostinfo-broadcast", 20, false},
                                              {"hostinfo-reply-cached", 0, true},
                                              {"hostinfo-reply-own", 0, false}}));
  const auto data = only(file).data;
  const auto x = decode_host_record_message(data);
  REQUIRE(x);
  if (id != 0)
    CHECK(x->record.id == peer_id{id});
  CHECK(x->cached == cached);
  CHECK(x->record.host_name.substr(0, 4) == "host");
  CHECK(x->record.full_name.find('@') != std::string::npos);
  CHECK(!x->record.marked);
  REQUIRE(!x->record.addresses.empty());
  CHECK(x->record.addresses[0].device == "lo");
  CHECK(x->record.addresses[0].loopback);
  ranges garbage{{8 + x->record.host_name.size(), 64 - x->record.host_name.size()},
                 {72 + x->record.full_name.size(), 64 - x->record.full_name.size()},
                 {137, 7},
                 {528, 8},
                 {540, 4},
                 {545, 7}};
  for (std::size_t i = 0; i < 16; ++i) {
    const auto at = 144 + 24 * i;
    garbage.push_back(i < x->record.addresses.size() ? std::pair(at + 9, 3UL)
                                                     : std::pair(at, 24UL));
  }
  CHECK(without(encode(*x), garbage) == without(data, garbage));
}

TEST_CASE("routing pages of real kernels decode and encode back", "[peis][RTE-04]") {
  const auto file =
      GENERATE(as<std::string>{}, "routing-one-page", "routing-two-pages", "routing-lost");
  for (const auto& x : packages(file)) {
    const auto page = decode_routing_page(x.data);
    REQUIRE(page);
    CHECK(without(encode(*page), {{6, 2}}) == without(x.data, {{6, 2}}));
  }
}

TEST_CASE("the lost route of a real kernel has hops 250", "[peis][RTE-06]") {
  const auto page = decode_routing_page(only("routing-lost").data);
  REQUIRE(page);
  CHECK(page->seqno == 14);
  REQUIRE(page->entries.size() == 3);
  CHECK(page->entries[0] == routing_entry{peer_id{30}, 3, 1189331032, 250, 2});
  CHECK(page->entries[2] == routing_entry{peer_id{10}, 14, 1480643328, 0, 4});
}

TEST_CASE("a table of 103 entries fills the pages as a real kernel does", "[peis][RTE-04]") {
  const auto captured_pages = packages("routing-two-pages");
  std::vector<routing_entry> entries;
  std::int32_t seqno = 0;
  for (const auto& x : captured_pages) {
    const auto page = decode_routing_page(x.data);
    REQUIRE(page);
    seqno = page->seqno;
    entries.insert(entries.end(), page->entries.begin(), page->entries.end());
  }
  CHECK(entries.size() == 103);
  const auto pages = paginate(entries, seqno);
  REQUIRE(pages.size() == captured_pages.size());
  for (std::size_t i = 0; i < pages.size(); ++i)
    CHECK(without(encode(pages[i]), {{6, 2}}) == without(captured_pages[i].data, {{6, 2}}));
}

TEST_CASE("acknowledgements of real kernels decode and encode back", "[peis][ACK-06]") {
  const auto [file, count] =
      GENERATE(table<std::string, std::size_t>({{"acks-one", 1}, {"acks-many", 11}}));
  const auto data = only(file).data;
  const auto ids = decode_acknowledgement(data);
  REQUIRE(ids);
  CHECK(ids->size() == count);
  CHECK(encode_acknowledgement(*ids) == data);
}

TEST_CASE("queries and dead-host notices of real kernels decode and encode back",
          "[peis][KH-01][KH-04]") {
  const auto query_data = only("query-host").data;
  const auto query = decode_host_query(query_data);
  REQUIRE(query);
  CHECK(query->asker == peer_id{10});
  CHECK(query->magic == any_magic);
  CHECK(encode(*query) == query_data);

  const auto exit_data = only("dead-host-exit").data;
  const auto exit = decode_dead_host(exit_data);
  REQUIRE(exit);
  CHECK(exit->host == peer_id{20});
  CHECK(exit->why == dead_host_message::reason::route);
  CHECK(encode(*exit) == exit_data);

  const auto reborn = packages("dead-host-reborn");
  REQUIRE(reborn.size() == 3);
  CHECK(decode_dead_host(reborn[0].data)->why == dead_host_message::reason::reborn);
  CHECK(reborn[0].header.ack_id == reborn[2].header.ack_id); // repeats: new id, same ack id
  CHECK(reborn[0].header.id != reborn[2].header.id);
}

TEST_CASE("pushed and set tuples of real kernels decode and encode back", "[peis][TUP-02]") {
  using kind = tuple_message_kind;
  const auto [file, name, text, which] =
      GENERATE(table<std::string, std::string, std::string, kind>(
          {{"push-first-value", "foo", "hello", kind::push},
           {"push-update", "foo", "world", kind::push},
           {"push-expiring", "temp", "short lived", kind::push},
           {"push-kernel-connections", "kernel.connections", "((20 250 250 0 0.00))", kind::push},
           {"push-metatuple", "mi-in", "(META 20 kernel.name)", kind::push},
           {"set-remote", "bar", "remote value", kind::set},
           {"set-delete", "bar", "", kind::set},
           {"set-metatuple", "mi-in", "(META 20 kernel.name)", kind::set}}));
  const auto data = only(file).data;
  const auto x = decode_tuple_message(data, {});
  REQUIRE(x);
  CHECK(x->name.text() == name);
  if (file != "push-metatuple" && file != "set-metatuple")
    CHECK(x->text() == text);
  CHECK(x->owner == peer_id{10});
  auto again = encode_tuple_head(*x, which);
  const auto value = to_bytes(encode_tuple_value(*x).view());
  again.insert(again.end(), value.begin(), value.end());
  CHECK(without(again, record_garbage(0, name.size() + 1)) ==
        without(data, record_garbage(0, name.size() + 1)));
}

TEST_CASE("append requests of real kernels decode and encode back", "[peis][TUP-07]") {
  const auto data = only("append-request").data;
  const auto x = decode_append_request(data, {});
  REQUIRE(x);
  CHECK(x->wanted == prototype_of(peer_id{10}, *key::parse("foo")));
  CHECK(rubicon::to_string(x->added.view()) == std::string("remotely", 9));
  auto again = encode_append_request_head(*x);
  again.insert(again.end(), x->added.view().begin(), x->added.view().end());
  CHECK(without(again, record_garbage(0, 4)) == without(data, record_garbage(0, 4)));
}

TEST_CASE("append notices of real kernels decode and encode back", "[peis][TUP-07]") {
  const auto notices = packages("push-appended");
  REQUIRE(notices.size() == 2);
  const std::size_t lengths[] = {6, 14};
  for (std::size_t i = 0; i < notices.size(); ++i) {
    CHECK(notices[i].header.port == port::append_notice);
    const auto& data = notices[i].data;
    const auto x = decode_append_notice(data);
    REQUIRE(x);
    CHECK(x->owner == peer_id{10});
    CHECK(x->name.text() == "foo");
    CHECK(x->seqno == 1);
    CHECK(x->append_seqno == static_cast<std::int32_t>(i));
    CHECK(x->length == lengths[i]);
    tuple before;
    before.owner = before.creator = peer_id{10};
    before.name = x->name;
    before.value = bytes(x->length);
    before.seqno = x->seqno;
    before.append_seqno = x->append_seqno;
    auto again = encode_append_notice_head(before, x->added.size());
    again.insert(again.end(), x->added.view().begin(), x->added.view().end());
    auto garbage = record_garbage(0, 4);
    garbage.pop_back();         // the append number is none in a notice
    garbage.emplace_back(8, 8); // the time of writing
    CHECK(without(again, garbage) == without(data, garbage));
  }
}

TEST_CASE("appends of a real kernel extend what its pushes gave", "[peis][TUP-07]") {
  tuple_space x({}, peer_id{20}, 1'000'000'000s);
  static_cast<void>(x.on_host_appeared(peer_id{10}, false, instant{}));
  static_cast<void>(x.subscribe(prototype_of(peer_id{10}, *key::parse("foo")), subscription_id{1},
                                tuple_space::interest::subscription, instant{}));
  CHECK(x.on_message(port::push, peer_id{10}, only("push-update").data, instant{}).size() == 1);
  for (const auto& notice : packages("push-appended"))
    CHECK(x.on_message(port::append_notice, peer_id{10}, notice.data, instant{}).size() == 1);
  CHECK(x.stored().content(peer_id{10}, *key::parse("foo"))->text().starts_with("worldand more"));
}

TEST_CASE("an expiring and a deleted tuple say so", "[peis][TUP-15][TUP-16]") {
  const auto expiring = decode_tuple_message(only("push-expiring").data, {});
  REQUIRE(expiring);
  CHECK(expiring->expiry == timestamp{1795231897, 119452});
  const auto gone = decode_tuple_message(only("set-delete").data, {});
  REQUIRE(gone);
  CHECK(gone->expiry == deleted);
}

TEST_CASE("subscriptions of real kernels decode and encode back", "[peis][TUP-08]") {
  const auto [file, owner, name] =
      GENERATE(table<std::string, int, std::string>({{"subscribe-exact", 10, "foo"},
                                                     {"subscribe-any-owner", -1, "kernel.*"},
                                                     {"subscribe-mime-data", 10, "a.*.c"}}));
  const auto data = only(file).data;
  const auto x = decode_subscribe(data, {});
  REQUIRE(x);
  CHECK(x->wanted.owner == peer_id{owner});
  CHECK(x->wanted.name.text() == name);
  CHECK(!x->lifetime);
  CHECK(x->wanted.mimetype.has_value() == (file == "subscribe-mime-data"));
  auto garbage = record_garbage(4, name.size() + 1);
  garbage.emplace_back(0, 4); // "force resend" is 0 or 1, nobody reads it
  CHECK(without(encode(*x), garbage) == without(data, garbage));
}

TEST_CASE("unsubscriptions of real kernels decode and encode back", "[peis][TUP-09]") {
  const auto [file, owner, name] = GENERATE(table<std::string, int, std::string>(
      {{"unsubscribe-exact", 10, "foo"}, {"unsubscribe-any-owner", -1, "wild.*"}}));
  const auto data = only(file).data;
  const auto x = decode_unsubscribe(data);
  REQUIRE(x);
  CHECK(x->owner == peer_id{owner});
  CHECK(x->name.text() == name);
  auto garbage = record_garbage(0, name.size() + 1);
  garbage.insert(garbage.end(), {{32, 5}, {40, 8}, {212, 4}}); // peis-wire.md 15.2
  CHECK(without(encode_unsubscribe(*x), garbage) == without(data, garbage));
}

TEST_CASE("the fragments of a real kernel reassemble in any order", "[peis][P2P-04]") {
  auto all = packages("push-fragments");
  REQUIRE(all.size() == 4);
  std::swap(all[0], all[3]);
  std::swap(all[1], all[2]);
  all.insert(all.begin() + 1, all.front()); // one repeated
  reassembly assembly{reassembly_config{}};
  std::optional<bytes> whole;
  for (const auto& x : all) {
    REQUIRE(!whole);
    REQUIRE(assembly.accepts(x.header));
    whole = assembly.add(x.header, x.data, instant{});
  }
  REQUIRE(whole);
  CHECK(whole->size() == 3248);
  const auto tuple = decode_tuple_message(*whole, {});
  REQUIRE(tuple);
  CHECK(tuple->form == encoding::binary);
  CHECK(tuple->value.size() == 3000);
  CHECK(assembly.size() == 0);
}

} // namespace rubicon::peis
