// Shapes of connectivity traces in the K7 format, valid and hostile.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;
using namespace std::chrono_literals;

std::string k7(const std::string& rows, const std::string& columns = "datetime,src,dst,pdr") {
  return "{}\n" + columns + "\n" + rows;
}

} // namespace

TEST_CASE("ratios of a K7 trace change over time", "[imports]") {
  const auto x = taken(format::k7, "{\"location\": \"hall\"}\ndatetime,src,dst,mean_rssi,pdr\n"
                                   "2018-01-11 16:32:15,a,b,-70,0.9\n"
                                   "2018-01-11 16:34:15,a,b,-70,0.25\n");
  CHECK(x.plan.title == "hall");
  CHECK(x.plan.length == 3min);
  REQUIRE(x.plan.links.size() == 1);
  CHECK(x.plan.links[0].gain_db == -70);
  REQUIRE(x.plan.changes.size() == 1);
  CHECK(x.plan.changes[0].at == 2min);
  CHECK(x.plan.changes[0].loss == 0.75);
}

TEST_CASE("ratios of all channels of a K7 trace become a mean", "[imports]") {
  const auto x = taken(format::k7, k7("2018-01-11 16:32:15,0,1,11,-60,1.0,100,0\n"
                                      "2018-01-11 16:32:20,0,1,12,-70,0.5,100,1\n",
                                      "datetime,src,dst,channel,mean_rssi,pdr,tx_count,"
                                      "transaction_id"));
  REQUIRE(x.plan.links.size() == 1);
  CHECK(x.plan.links[0].loss == 0.25);
  CHECK(x.plan.links[0].gain_db == -65);
  CHECK(noted(x, "channels: ratios are means") == text_place{2, 18});
}

TEST_CASE("columns of a K7 trace may come in any order, `prr` for `pdr`", "[imports]") {
  const auto x = taken(format::k7, k7("0.5,b,2018-01-11T16:32:15.123,a\n", "prr,dst,datetime,src"));
  REQUIRE(x.plan.links.size() == 1);
  CHECK(x.plan.links[0].loss == 0.5);
  CHECK(x.plan.links[0].gain_db == -60);
}

TEST_CASE("a link of a K7 trace that is measured later loses all before", "[imports]") {
  const auto x = taken(format::k7, k7("2018-12-31 23:59:59,a,b,1\n2019-01-01 00:00:00,b,a,0.75\n"));
  REQUIRE(x.plan.links.size() == 2);
  CHECK(x.plan.links[1].loss == 1);
  REQUIRE(x.plan.changes.size() == 1);
  CHECK(x.plan.changes[0].at == 1min);
  CHECK(x.plan.changes[0].loss == 0.25);
}

TEST_CASE("rows of a K7 trace may be in any order, changes below 1 % are none", "[imports]") {
  const auto x = taken(format::k7, k7("2018-01-11 16:35:00,a,b,0.495\n"
                                      "2018-01-11 16:32:00,a,b,0.5\n\n"));
  CHECK(x.plan.changes.empty());
  CHECK(x.plan.links.at(0).loss == 0.5);
}

TEST_CASE("weak signals and gaps of a K7 trace are noted and taken", "[imports]") {
  const auto x = taken(format::k7, k7("2018-01-11 16:32:15,a,b,-95,1\n2018-01-11 16:32:15,b,a,,1\n",
                                      "datetime,src,dst,mean_rssi,pdr"));
  REQUIRE(x.plan.links.size() == 2);
  CHECK(x.plan.links[0].gain_db == -80);
  CHECK(x.plan.links[1].gain_db == -60);
  CHECK(noted(x, "signals below -80 dBm") == text_place{});
}

TEST_CASE("a header of a K7 trace may hold anything, with CR LF", "[imports]") {
  const auto x = taken(format::k7, "{\"location\": \"\\u001b[2J\\n\", \"node_count\": [1, {}]}\r\n"
                                   "datetime,src,dst,pdr\r\n2018-01-11 16:32:15,a b,\xff,1\r\n");
  CHECK(x.plan.motes.size() == 2);
  CHECK(toml_of(x, format::k7, "a", "").find('\x1b') == std::string::npos);
}

TEST_CASE("a K7 trace without header, columns or rows is refused", "[imports]") {
  CHECK(refused(format::k7, "") == "1:1: the header is missing");
  CHECK(refused(format::k7, "datetime,src,dst,pdr\n") ==
        "1:1: the header must be a line with a JSON object");
  CHECK(refused(format::k7, "{}") == "1:1: no names of columns follow this line");
  CHECK(refused(format::k7, k7("", "datetime,src,pdr")) == "2:17: there is no column `dst`");
  CHECK(refused(format::k7, k7("")).find("there is no measurement") != std::string::npos);
  CHECK_FALSE(refused(format::k7, std::string(100'000, '[') + "\n").empty());
}

TEST_CASE("rows of a K7 trace with a field too many or a wrong time are refused", "[imports]") {
  CHECK(refused(format::k7, k7("2018-01-11 16:32:15,a,b,1,2\n")) ==
        "3:1: the row has 5 fields, not 4");
  for (const auto* x : {"2018-02-30 10:00:00", "2018-01-11 24:00:00", "2018-13-01 10:00:00",
                        "yesterday", "2018-01-11 10:60:00", ""}) {
    INFO(x);
    CHECK(refused(format::k7, k7(std::string(x) + ",a,b,1\n")).substr(0, 4) == "3:1:");
  }
  CHECK(refused(format::k7, k7("2018-01-11 16:32:15,a,a,1\n")) ==
        "3:23: a link leads from one node to another");
  CHECK(refused(format::k7, k7("2018-01-11 16:32:15,,a,1\n")).substr(0, 2) == "3:");
}

TEST_CASE("numbers of a K7 trace have limits", "[imports]") {
  for (const auto* x : {"1.01", "-0.01", "nan", "1%", ""}) {
    INFO(x);
    CHECK(
        refused(format::k7, k7("2018-01-11 16:32:15,a,b," + std::string(x) + "\n")).substr(0, 5) ==
        "3:25:");
  }
  CHECK(refused(format::k7, k7("2018-01-11 16:32:15,a,b,1,21\n", "datetime,src,dst,pdr,mean_rssi"))
            .find("mean_rssi must be a number from -200 to 20") != std::string::npos);
  CHECK(refused(format::k7, k7("2018-01-11 16:32:15,a,b,1\n2019-01-13 16:32:15,a,b,1\n")) ==
        "0:0: it covers more than a year");
  taken(format::k7, k7("2018-01-11 16:32:15,a,b,1\n2019-01-12 16:32:15,a,b,1\n"));
}
