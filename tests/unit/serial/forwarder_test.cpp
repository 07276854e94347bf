#include <map>
#include <string>

#include "serial/forwarder.hpp"
#include "serial/reopening.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using namespace rubicon::serial::test;

namespace {

std::map<std::string, bytes> streams() {
  std::map<std::string, bytes> all;
  for (const auto& x : rubicon::test::read_cases("tinyos/sf-stream.txt"))
    all[x.at("name")] = hex(x.at("bytes"));
  return all;
}

bytes sum(bytes a, const bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

forwarder_decoder greeted() {
  forwarder_decoder x;
  CHECK(x.on_octets(forwarder_greeting()).empty());
  CHECK(x.greeted());
  return x;
}

} // namespace

TEST_CASE("the forwarder's protocol is what TinyOS's tools write and read", "[serial][GW-17]") {
  const auto given = streams();
  CHECK(forwarder_greeting() == given.at("sf-01"));
  CHECK(forwarder_greeting() == given.at("sf-02"));

  auto client = greeted();
  const auto packet = hex("00 ff ff 00 01 02 22 06 00 01");
  CHECK(encode_forwarded(packet) == given.at("sf-03"));
  CHECK(client.on_octets(given.at("sf-03")) == std::vector<bytes>{packet});

  auto server = greeted();
  const auto from_client = hex("00 ff ff 00 00 02 22 06 01 02");
  CHECK(server.on_octets(given.at("sf-04")) == std::vector<bytes>{from_client});
  CHECK(server.on_octets(given.at("sf-05")) == std::vector<bytes>{packet, from_client});

  bytes longest(255);
  for (std::size_t i = 1; i < longest.size(); ++i)
    longest[i] = static_cast<std::uint8_t>(i - 1);
  CHECK(encode_forwarded(longest) == given.at("sf-10"));
  CHECK(client.on_octets(given.at("sf-10")) == std::vector<bytes>{longest});
}

TEST_CASE("a peer of a later version is greeted, one of another kind is not", "[serial][GW-17]") {
  const auto given = streams();
  forwarder_decoder later;
  CHECK(later.on_octets(sum(given.at("sf-06"), given.at("sf-04"))).size() == 1);
  CHECK(later.greeted());
  forwarder_decoder other;
  CHECK(other.on_octets(sum(given.at("sf-07"), given.at("sf-04"))).empty());
  CHECK(other.refused() == refusal::other_protocol);
  CHECK(!other.greeted());
  forwarder_decoder old;
  CHECK(old.on_octets(sum(given.at("sf-08"), given.at("sf-04"))).empty());
  CHECK(old.refused() == refusal::old_version);
}

TEST_CASE("a packet of no octets ends a connection, whatever follows", "[serial][GW-17]") {
  auto x = greeted();
  const auto given = streams();
  CHECK(x.on_octets(sum(given.at("sf-04"), sum(given.at("sf-09"), given.at("sf-04")))).size() == 1);
  CHECK(x.refused() == refusal::empty_packet);
  CHECK(x.on_octets(given.at("sf-04")).empty());
}

TEST_CASE("packets come out of any pieces of a stream", "[serial][GW-17]") {
  const auto whole = sum(forwarder_greeting(), streams().at("sf-05"));
  for (std::size_t size = 1; size < whole.size(); ++size) {
    forwarder_decoder x;
    std::size_t packets = 0;
    for (std::size_t at = 0; at < whole.size(); at += size)
      packets +=
          x.on_octets(byte_view(whole).subspan(at, std::min(size, whole.size() - at))).size();
    CHECK(packets == 2);
  }
}

TEST_CASE("behind a forwarder a gateway talks in frames all the same, and gets its acks",
          "[serial][GW-17]") {
  forwarder_line line;
  CHECK(line.on_connected() == forwarder_greeting());
  CHECK(line.on_forwarder(forwarder_greeting()).to_pc.empty());
  host_port pc;
  const auto packet = numbered_packet(7, 10);
  auto written = all<to_line>(pc.send(packet_id{1}, packet, instant{}));
  REQUIRE(written.size() == 1);
  const auto down = line.on_pc(written[0].octets);
  CHECK(down.to_forwarder == encode_forwarded(packet));
  CHECK(all<sent>(pc.on_bytes(down.to_pc, instant{})).size() == 1);

  const auto up = line.on_forwarder(encode_forwarded(packet));
  const auto got = all<received>(pc.on_bytes(up.to_pc, instant{}));
  REQUIRE(got.size() == 1);
  CHECK(got[0].packet == packet);
  CHECK(pc.counters().acks_written == 0);
}

TEST_CASE("half a packet of a connection that was lost is not completed by the next",
          "[serial][GW-17]") {
  forwarder_line line;
  static_cast<void>(line.on_connected());
  CHECK(line.on_forwarder(sum(forwarder_greeting(), hex("0a 00 ff"))).to_pc.empty());
  static_cast<void>(line.on_connected());
  CHECK(!line.greeted());
  const auto packet = numbered_packet(1, 4);
  const auto again = line.on_forwarder(sum(forwarder_greeting(), encode_forwarded(packet)));
  CHECK(again.to_pc == encode(frame{frame_type::packet, 0, packet}));
}

TEST_CASE("what is lost is looked for more and more rarely, until it has lasted",
          "[serial][GW-17]") {
  reopening x;
  duration waits[7];
  for (auto& each : waits)
    each = x.on_closed(start);
  CHECK(waits[0] == 500ms);
  CHECK(waits[1] == 1s);
  CHECK(waits[4] == 8s);
  CHECK(waits[5] == 10s);
  CHECK(waits[6] == 10s);
  x.on_opened(start);
  CHECK(x.on_closed(start + 9s) == 10s);
  x.on_opened(start);
  CHECK(x.on_closed(start + 10s) == 500ms);
}
