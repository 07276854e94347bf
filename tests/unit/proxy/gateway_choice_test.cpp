#include "proxy/gateway_choice.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using proxy::gateway_choice;

namespace {

constexpr peer_id first{20};
constexpr peer_id second{21};

std::vector<std::string> keys_of(const std::vector<gateway_choice::tuple_change>& x) {
  std::vector<std::string> all;
  for (const auto& each : x)
    all.push_back(each.deleted ? "no " + each.key : each.key + " " + to_string(each.value));
  return all;
}

std::vector<std::string> say(gateway_choice& x, peer_id from, std::string_view key,
                             std::string_view text) {
  return keys_of(x.on_tuple(from, key, to_bytes(text)));
}

using list = std::vector<std::string>;

} // namespace

TEST_CASE("one gateway is always listened to", "[proxy][PXY-14]") {
  gateway_choice x({first});
  CHECK(say(x, first, "devices", "{7}") == list{"devices {7}"});
  CHECK(keys_of(x.on_list_deleted(first)) == list{"no devices"});
}

TEST_CASE("of several gateways the one that leads is listened to", "[proxy][PXY-14][GW-14]") {
  gateway_choice x({first, second});
  CHECK(say(x, first, "devices", "{7}") == list{"devices {7}"});
  CHECK(say(x, second, "devices", "{7,8}").empty());
  CHECK(say(x, second, "devices.8.status", "listed 1.000000").empty());
  CHECK(say(x, first, "devices.role", "leads 1.000000").empty());
  CHECK(say(x, second, "devices.role", "stands_by 1.000000").empty());
  CHECK(x.current() == first);
  // the list comes last, so that motes are known by then
  CHECK(say(x, second, "devices.role", "leads 9.000000") ==
        list{"devices.8.status listed 1.000000", "devices {7,8}"});
  CHECK(x.current() == second);
  CHECK(say(x, first, "devices", "{}").empty());
  CHECK(say(x, second, "devices.role", "stands_by 11.000000").empty());
  CHECK(x.current() == second); // until somebody else leads
  CHECK(say(x, peer_id{99}, "devices", "{1}").empty());
  CHECK(say(x, first, "devices.role", "is king").empty());
}

TEST_CASE("an island is out of reach only when none of its gateways is there",
          "[proxy][PXY-14][GW-14]") {
  gateway_choice x({first, second});
  static_cast<void>(say(x, first, "devices", "{7}"));
  static_cast<void>(say(x, second, "devices", "{7}"));
  CHECK(x.on_list_deleted(first).empty());
  CHECK(keys_of(x.on_list_deleted(second)) == list{"no devices"});
  CHECK(say(x, second, "devices", "{7}").empty());
  CHECK(say(x, second, "devices.role", "leads 5.000000") == list{"devices {7}"});
}
