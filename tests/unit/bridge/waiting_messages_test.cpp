#include <string>

#include "bridge/table/waiting_messages.hpp"
#include "support/catch.hpp"

using namespace rubicon::bridge;

TEST_CASE("of messages that wait the newest of each topic is left", "[bridge]") {
  waiting_messages x;
  CHECK_FALSE(x.keep("a", "1"));
  CHECK_FALSE(x.keep("b", "2"));
  CHECK(x.keep("a", "longer"));
  CHECK(x.forget("b"));
  CHECK_FALSE(x.forget("b"));
  const auto all = x.take();
  REQUIRE(all.size() == 1);
  CHECK(all.at("a") == "longer");
  CHECK(x.empty());
}

TEST_CASE("messages wait of so many topics, and of so many octets in all", "[bridge]") {
  waiting_messages x;
  for (std::size_t i = 0; i < waiting_messages::topics_max; ++i)
    REQUIRE_FALSE(x.keep(std::to_string(i), "x"));
  CHECK(x.keep("one more", "x"));
  CHECK(x.keep("0", "newer")); // those that wait may still change
  CHECK(x.size() == waiting_messages::topics_max);
  CHECK(x.take().at("0") == "newer");

  const std::string most(waiting_messages::octets_max - 1, 'x');
  CHECK_FALSE(x.keep("a", most));
  CHECK(x.keep("b", ""));         // one octet is too much
  CHECK(x.keep("a", most + 'x')); // and so it is here: what waits stays
  CHECK(x.keep("a", "1"));
  CHECK_FALSE(x.keep("b", std::string(1000, 'x')));
  CHECK(x.take().at("a") == "1");
  CHECK_FALSE(x.keep("a", most)); // all room is there again
}
