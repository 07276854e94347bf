// Parts of a kernel that decide alone: requests to quit, ports of messages.
#include "peis/kernel/message_ports.hpp"
#include "peis/tuples/quit_requests.hpp"
#include "support/catch.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis {
namespace {

using test::start;

TEST_CASE("a request to quit ends when its owner vanishes or stays for 6 s", "[peis][TUP-22]") {
  const peer_id owner{2};
  quit_requests x;
  x.expect(request_id{1}, owner);
  x.expect(request_id{2}, owner);
  CHECK(x.take_succeeded(owner).empty()); // neither is acknowledged yet
  CHECK(!x.deadline());
  CHECK(!x.on_delivered(request_id{3}, start));
  CHECK(x.on_delivered(request_id{1}, start));
  x.on_undelivered(request_id{2});
  CHECK(!x.on_delivered(request_id{2}, start));
  CHECK(x.deadline() == start + 6s);
  SECTION("it vanishes") {
    CHECK(x.take_succeeded(peer_id{3}).empty());
    CHECK(x.take_succeeded(owner) == std::vector<request_id>{request_id{1}});
  }
  SECTION("it stays") {
    CHECK(x.take_refused(start + 6s - 1us).empty());
    CHECK(x.take_refused(start + 6s) == std::vector<request_id>{request_id{1}});
  }
  CHECK(!x.deadline());
}

TEST_CASE("messages for ports without hook are counted and dropped", "[peis][API-09]") {
  message_ports x;
  CHECK(!x.hook(port::user_first - 1));
  CHECK(!x.hook(port::count));
  CHECK(x.hook(port::user_first));
  CHECK(x.hook(port::count - 1));
  outputs out;
  x.deliver({port::user_first, peer_id{2}, false, payload()}, out);
  x.deliver({port::user_first + 1, peer_id{2}, false, payload()}, out);
  REQUIRE(out.size() == 1);
  CHECK(std::get<message>(out[0]).port == port::user_first);
  CHECK(x.unhooked() == 1);
}

} // namespace
} // namespace rubicon::peis
