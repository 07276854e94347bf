// Announcements, clock broadcasts and traces against octets of real kernels, both ways.
#include "peis/link/link.hpp"
#include "peis/overlay/network_clock.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/trace.hpp"
#include "support/catch.hpp"
#include "unit/peis/capture.hpp"

namespace rubicon::peis {
namespace {

using test::capture;

/// The data of the only package of a capture, whose header encodes back to its octets.
bytes only_data(const std::string& name, package_header& header) {
  const auto stream = capture(name);
  stream_decoder decoder;
  decoder.feed(stream);
  const auto x = decoder.next();
  REQUIRE(x);
  header = x->header;
  bytes again;
  encode(header, again);
  again.insert(again.end(), x->data.begin(), x->data.end());
  CHECK(to_hex(again) == to_hex(stream));
  return to_bytes(x->data);
}

} // namespace

TEST_CASE("an announcement of a real kernel", "[peis][TCP-03][golden]") {
  const auto octets = capture("announce");
  const auto x = decode_announcement(octets);
  REQUIRE(x);
  CHECK(x->version == 500);
  CHECK(x->network == "default");
  CHECK(x->sender.id == peer_id{10});
  CHECK(x->sender.magic == 1389641514);
  CHECK(x->sender.host_name == "hostA");
  CHECK(x->sender.full_name == "kpeer@hostA!25009");
  REQUIRE(x->sender.addresses.size() == 1);
  CHECK(x->sender.addresses[0].loopback);
  CHECK(to_string(url_of(x->sender.addresses[0])) == "tcp://127.0.0.1:8000");
  CHECK(x->sender.cluster == 10);
  CHECK(!x->sender.marked);
  CHECK(to_hex(encode(*x)) == to_hex(octets));
  CHECK(!decode_announcement(byte_view(octets).first(615)));
  auto longer = octets;
  longer.push_back(0);
  CHECK(!decode_announcement(longer));
}

TEST_CASE("clock broadcasts of a master and of an equal", "[peis][CLK-06][golden]") {
  package_header header;
  const auto master = only_data("timesync-master", header);
  CHECK(header.port == port::clock);
  CHECK(header.type == package_type::broadcast);
  const auto x = decode_clock(master, 0s);
  REQUIRE(x);
  CHECK(x->master);
  CHECK(x->network_time == 1795231323s + 439174us);
  CHECK(to_hex(encode(*x)) == to_hex(master));
  const auto plain = only_data("timesync-plain", header);
  const auto y = decode_clock(plain, 0s);
  REQUIRE(y);
  CHECK(!y->master);
  CHECK(to_hex(encode(*y)) == to_hex(plain));
  CHECK(!decode_clock(byte_view(plain).first(11), 0s));
}

TEST_CASE("a trace and its answer", "[peis][API-12][golden]") {
  package_header header;
  const auto asked = only_data("trace", header);
  CHECK(header.port == port::trace);
  const auto question = decode_trace(asked);
  REQUIRE(question);
  CHECK(question->hosts == std::vector<peer_id>{peer_id{20}});
  CHECK(to_hex(encode(*question)) == to_hex(asked));
  const auto told = only_data("trace-reply", header);
  CHECK(header.port == port::trace_reply);
  const auto answer = decode_trace(told);
  REQUIRE(answer);
  CHECK(answer->hosts.front() == peer_id{20});
  CHECK(answer->hosts.size() >= 2);
  CHECK(to_hex(encode(*answer)) == to_hex(told));
  auto many = asked;
  many[3] = 16;
  CHECK(!decode_trace(many));
  many[3] = 0;
  CHECK(!decode_trace(many));
}

} // namespace rubicon::peis
