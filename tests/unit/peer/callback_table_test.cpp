// Callbacks and warnings of a peer that a program drives.
#include "peer/callback_table.hpp"
#include "peer/warnings.hpp"
#include "support/catch.hpp"

namespace rubicon::peer {
namespace {

TEST_CASE("a callback that is removed while it is to be called is called", "[peer][CB-04]") {
  callback_table x;
  int changes = 0;
  const auto id = x.add_watcher([&](const auto&) { ++changes; }, {});
  const peis::tuple_changed event{id, std::make_shared<const peis::tuple>()};
  const auto call = x.on(event);
  x.remove_watcher(id);
  REQUIRE(call);
  call();
  CHECK(changes == 1);
  CHECK(!x.on(event));
}

TEST_CASE("an outcome is for one callback, once", "[peer][API-04]") {
  callback_table x;
  int ended = 0;
  const auto first = x.add_request([&](const auto&) { ++ended; });
  const auto second = x.add_request({});
  CHECK(first != second);
  const auto call = x.on(peis::outcome{first, true, peis::cause::none});
  REQUIRE(call);
  call();
  CHECK(ended == 1);
  CHECK(!x.on(peis::outcome{first, true, peis::cause::none}));
  CHECK(!x.on(peis::outcome{second, true, peis::cause::none}));
}

TEST_CASE("a route is kept only for a request that expects it", "[peer][API-12]") {
  callback_table x;
  const auto request = x.add_request({});
  peis::traced found{request, peer_id{2}, {peer_id{1}, peer_id{2}, peer_id{1}}};
  auto unexpected = found;
  x.on(unexpected);
  x.expect_route(request);
  CHECK(!x.has_route(request));
  x.on(found);
  REQUIRE(x.has_route(request));
  CHECK(x.take_route(request).size() == 3);
}

TEST_CASE("a warning of one kind is given once in 10 s", "[peer][NFR-09]") {
  std::vector<std::string> given;
  warnings x([&](const std::string& text) { given.push_back(text); });
  const instant start{};
  x.give(warnings::kind::slow_callback, "a", start);
  x.give(warnings::kind::slow_callback, "b", start + warnings::gap - 1us);
  x.give(warnings::kind::rare_steps, "c", start + 1s);
  x.give(warnings::kind::slow_callback, "d", start + warnings::gap);
  x.give("e");
  CHECK(given == std::vector<std::string>{"a", "c", "d", "e"});
  warnings(nullptr).give("to no receiver");
}

} // namespace
} // namespace rubicon::peer
