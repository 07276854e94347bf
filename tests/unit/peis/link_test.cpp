// The octet stream of a link, and what must be refused (peis-wire.md 3.4, 23).
#include "core/numbers/random.hpp"
#include "peis/link/link.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/wire/acknowledgement.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/layout.hpp"
#include "peis/wire/routing_page.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

package_header header_of(std::int32_t id, std::size_t length) {
  package_header x;
  x.id = x.ack_id = id;
  x.source = peer_id{1};
  x.destination = peer_id{2};
  x.port = 20;
  x.length = static_cast<std::uint16_t>(length);
  return x;
}

bytes stream_of(std::size_t count, random_stream& rng) {
  bytes out;
  for (std::size_t i = 1; i <= count; ++i) {
    const auto length = i % 5 == 0 ? data_max : rng.below(300);
    encode(header_of(static_cast<std::int32_t>(i), length), out);
    out.insert(out.end(), length, static_cast<std::uint8_t>(i));
  }
  return out;
}

} // namespace

TEST_CASE("packages come out whole, whatever the pieces", "[peis][TCP-05]") {
  const auto longest = GENERATE(1U, 2U, 7U, 39U, 41U, 1000U, 100000U);
  random_stream rng(longest);
  const auto stream = stream_of(60, rng);
  stream_decoder decoder;
  std::int32_t expected = 1;
  for (std::size_t at = 0; at < stream.size();) {
    const auto size = std::min<std::size_t>(1 + rng.below(longest), stream.size() - at);
    const bytes piece = to_bytes(byte_view(stream).subspan(at, size));
    decoder.feed(piece);
    while (const auto x = decoder.next()) {
      CHECK(x->header.id == expected);
      CHECK(x->data.size() == x->header.length);
      if (!x->data.empty())
        CHECK(x->data.back() == expected);
      ++expected;
    }
    at += size;
  }
  CHECK(expected == 61);
  CHECK(!decoder.broken());
}

TEST_CASE("the connect request is taken before the first package", "[peis][LNK-06]") {
  random_stream rng(1);
  auto stream = encode(connect_request{500, peer_id{7}, 5, "net"});
  const auto packages = stream_of(1, rng);
  stream.insert(stream.end(), packages.begin(), packages.end());
  stream_decoder decoder;
  for (std::size_t i = 0; i < 75; ++i) {
    decoder.feed(byte_view(stream).subspan(i, 1));
    REQUIRE(!decoder.take_connect_request());
  }
  decoder.feed(byte_view(stream).subspan(75));
  const auto request = decoder.take_connect_request();
  REQUIRE(request);
  CHECK(decode_connect_request(*request)->id == peer_id{7});
  CHECK(decoder.next());
}

TEST_CASE("a stream with a wrong sync word, length or id is broken", "[peis][TCP-06]") {
  const auto [offset, value] = GENERATE(table<std::size_t, int>(
      {{0, 0xfe}, {3, 0x01}, {4, 0x80}, {12, 0x80}, {30, 0x04}})); // 0x0401: one too many
  bytes stream;
  encode(header_of(1, 1), stream);
  stream.push_back(0);
  stream[offset] = static_cast<std::uint8_t>(value);
  stream_decoder decoder;
  decoder.feed(stream);
  CHECK(!decoder.next());
  CHECK(decoder.broken());
}

TEST_CASE("what would harm a real kernel is illegal", "[peis][API-09]") {
  auto x = header_of(1, 10);
  CHECK(is_legal(x));
  SECTION("port 50") {
    x.port = 50;
  }
  SECTION("type 3") {
    x.type = static_cast<package_type>(3);
  }
  SECTION("source 0") {
    x.source = peer_id{0};
  }
  SECTION("direct to everybody") {
    x.destination = any_peer;
  }
  SECTION("id 0") {
    x.id = 0;
  }
  SECTION("fragment number not below their count") {
    x.seqlen = 2;
    x.seqnum = 2;
  }
  SECTION("a fragment in the middle that is not full") {
    x.seqlen = 2;
    x.seqnum = 0;
  }
  SECTION("more fragments than 16 MiB") {
    x.seqlen = fragments_max + 1;
    x.seqnum = fragments_max;
  }
  SECTION("a long broadcast") {
    x.type = package_type::broadcast;
    x.seqlen = 1;
  }
  CHECK(!is_legal(x));
}

TEST_CASE("a host record with more than 16 addresses or a name without NUL is refused",
          "[peis][KH-03]") {
  host_record x;
  x.id = peer_id{1};
  x.addresses.resize(low_level_addresses_max);
  bytes octets;
  encode(x, octets);
  CHECK(decode_host_record(octets));
  SECTION("17 addresses") {
    octets[136] = 17;
  }
  SECTION("name") {
    std::fill_n(octets.begin() + 8, 64, 'a');
  }
  SECTION("id 0") {
    octets[3] = 0;
  }
  SECTION("short") {
    octets.pop_back();
  }
  CHECK(!decode_host_record(octets));
}

TEST_CASE("the liveness mark survives a record's journey", "[peis][A-76]") {
  host_record x;
  x.id = peer_id{1};
  x.marked = true;
  x.host_name = "kitchen";
  x.addresses = {{"ethernet0", false, low_level_address::kind::bluetooth, {1, 2, 3}}};
  const auto again = decode_host_record_message(encode(host_record_message{x, true}));
  REQUIRE(again);
  CHECK(again->cached);
  x.addresses[0].device = "ethernet"; // 8 characters
  CHECK(again->record == x);
}

TEST_CASE("routing pages that a real kernel chokes on are refused", "[peis][RTE-04]") {
  routing_page x{0, 1, 5, {{peer_id{1}, 5, 9, 0, 1}}};
  auto octets = encode(x);
  CHECK(*decode_routing_page(octets) == x);
  SECTION("page number") {
    octets[1] = 1;
  }
  SECTION("33 pages") {
    octets[3] = 33;
  }
  SECTION("no pages") {
    octets[3] = 0;
  }
  SECTION("not the last and not full") {
    octets[3] = 2;
  }
  SECTION("71 entries") {
    octets[5] = 71;
  }
  SECTION("fewer entries than announced") {
    octets[5] = 2;
  }
  CHECK(!decode_routing_page(octets));
}

TEST_CASE("an acknowledgement that announces more than it holds is refused", "[peis][ACK-06]") {
  CHECK(!decode_acknowledgement(bytes{0, 0, 0, 2, 0, 0, 0, 1}));
  CHECK(!decode_acknowledgement(bytes{0xff, 0xff, 0xff, 0xff}));
  CHECK(!decode_acknowledgement(bytes{0, 0}));
  CHECK(decode_acknowledgement(bytes{0, 0, 0, 0}));
}

TEST_CASE("tuples that are not concrete are refused", "[peis][TUP-06]") {
  tuple x;
  x.owner = x.creator = peer_id{1};
  x.name = *key::parse("a.b");
  x.mimetype = "text/plain";
  x.value = payload(bytes{'x', 0});
  auto octets = encode_tuple_head(x, tuple_message_kind::push);
  octets.insert(octets.end(), {'x', 0});
  CHECK(decode_tuple_message(octets, {}));
  SECTION("owner") {
    std::fill_n(octets.begin(), 4, 0xff);
  }
  SECTION("creator") {
    std::fill_n(octets.begin() + 4, 4, 0xff);
  }
  SECTION("user time") {
    std::fill_n(octets.begin() + 16, 8, 0xff);
  }
  SECTION("expiry") {
    std::fill_n(octets.begin() + 24, 8, 0xff);
  }
  SECTION("encoding") {
    std::fill_n(octets.begin() + 32, 4, 0xff);
  }
  SECTION("encoding unknown") {
    octets[35] = 2;
  }
  SECTION("no data flag") {
    std::fill_n(octets.begin() + 40, 4, 0);
  }
  SECTION("no MIME type") {
    octets[36] = 0;
  }
  SECTION("MIME type longer than the message") {
    octets[36] = 200;
  }
  SECTION("no value") {
    octets.resize(octets.size() - 2);
  }
  SECTION("wildcard key") {
    octets[84] = '*';
  }
  SECTION("key without NUL") {
    std::fill_n(octets.begin() + 84, 128, 'k');
  }
  SECTION("cut in the record") {
    octets.resize(223);
  }
  CHECK(!decode_tuple_message(octets, {}));
}

TEST_CASE("an empty value travels as one zero octet with its own MIME type", "[peis][TUP-02]") {
  tuple x;
  x.owner = x.creator = peer_id{1};
  x.name = *key::parse("a");
  x.mimetype = empty_mimetype;
  auto octets = encode_tuple_head(x, tuple_message_kind::push);
  const auto value = encode_tuple_value(x);
  CHECK(value.size() == 1);
  octets.push_back(0);
  const auto again = decode_tuple_message(octets, {});
  REQUIRE(again);
  CHECK(again->value.empty());
}

TEST_CASE("the times of tuples go on after the wire's 32 bits", "[peis]") {
  const auto again = [](timestamp time, timestamp known) {
    tuple x;
    x.owner = x.creator = peer_id{1};
    x.name = *key::parse("a");
    x.value = payload(bytes{'x', 0});
    x.written = x.expiry = time;
    auto octets = encode_tuple_head(x, tuple_message_kind::push);
    octets.insert(octets.end(), {'x', 0});
    const auto read = decode_tuple_message(octets, known);
    REQUIRE(read);
    CHECK(read->written == read->expiry);
    return read->expiry;
  };
  constexpr std::int64_t sign = 1LL << 31;
  constexpr std::int64_t wrap = 1LL << 32;
  for (const std::int64_t known : {sign - 1, sign, wrap - 5, wrap, wrap + 5})
    for (const std::int64_t later : {-100'000'000, 2, 3, 100'000'000}) {
      CAPTURE(known, later);
      CHECK(again({known + later, 7}, {known, 0}) == timestamp{known + later, 7});
    }
  for (const auto meaning : {never, deleted})
    CHECK(again(meaning, {wrap + 5, 0}) == meaning);
  for (const std::int64_t late : {-1, 0, 1}) // would mean something else
    CHECK(again({wrap + late, 7}, {wrap + 5, 0}) == timestamp{wrap + 2, 7});
}

} // namespace rubicon::peis
