// Shapes of movements for ns-2 and ns-3, valid and hostile.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;
using namespace std::chrono_literals;

} // namespace

TEST_CASE("a mote of setdest that turns on its route has a corner there", "[imports]") {
  const auto x = taken(format::setdest, "$node_(0) set X_ 5.0\n$node_(0) set Y_ 2.0\n"
                                        "$ns_ at 10.0 \"$node_(0) setdest 15.0 2.0 2.5\"\n"
                                        "$ns_ at 12.0 \"$node_(0) setdest 10.0 12.0 1.0\"\n");
  const auto& path = x.plan.motes.at(0).path;
  REQUIRE(path.size() == 3);
  CHECK(path[0] == std::pair<duration, point>(10s, {5, 2, 0}));
  CHECK(path[1] == std::pair<duration, point>(12s, {10, 2, 0}));
  CHECK(path[2] == std::pair<duration, point>(22s, {10, 12, 0}));
}

TEST_CASE("the sink of movements is the first mote that stays, or else stands still", "[imports]") {
  const std::string moving = "$node_(1) set X_ 1\n$node_(1) set Y_ 1\n"
                             "$ns_ at 1 \"$node_(1) setdest 9 1 1\"\n";
  const auto x = taken(format::setdest, moving + "$node_(2) set X_ 5\n$node_(2) set Y_ 5\n");
  CHECK(x.sink == 1);
  CHECK(noted(x, "movements of the sink") == text_place{0, 1});
  const auto all_move = taken(format::setdest, moving);
  CHECK(all_move.sink == 0);
  CHECK(noted(all_move, "movements of the sink, which stays") == text_place{});
}

TEST_CASE("movements with tabs, CR LF, a byte order mark and without a last newline are taken",
          "[imports]") {
  const auto x =
      taken(format::setdest, "\xef\xbb\xbf# made by hand\r\n\r\n\t$node_(3)\tset\tX_ +1.5"
                             "\r\n$node_(3) set Y_ -2\r\n$node_(3) set Z_ 1e1");
  REQUIRE(x.plan.motes.size() == 1);
  CHECK(x.plan.motes[0].number == 3);
  CHECK(x.plan.motes[0].place == point{1.5, -2, 10});
}

TEST_CASE("distances of god, variables and jumps of movements are not taken", "[imports]") {
  const auto x = taken(format::setdest, "set val(nn) 2\n$god_ set-dist 0 1 1\n$node_(0) set X_ 1\n"
                                        "$ns_ at 3 \"$god_ set-dist 0 1 2\"\n"
                                        "$ns_ at 4 \"$node_(0) set X_ 7\"\n");
  CHECK(noted(x, "variables of Tcl") == text_place{1, 1});
  CHECK(noted(x, "distances of `$god_`") == text_place{2, 1});
  CHECK(noted(x, "jumps (`set` at a time)") == text_place{5, 22});
  CHECK(x.plan.motes.at(0).place.x_m == 1);
}

TEST_CASE("a speed of 0 stops a mote of setdest where it is", "[imports]") {
  const auto x = taken(format::setdest, "$node_(0) set X_ 0\n$node_(1) set X_ 0\n"
                                        "$ns_ at 0 \"$node_(1) setdest 10 0 1\"\n"
                                        "$ns_ at 4 \"$node_(1) setdest 90 0 0\"\n");
  const auto& path = x.plan.motes.at(1).path;
  REQUIRE_FALSE(path.empty());
  CHECK(path.back() == std::pair<duration, point>(4s, {4, 0, 0}));
}

TEST_CASE("a run of movements is as long as the last of them, but ten minutes at least",
          "[imports]") {
  const auto length = [](const std::string& at) {
    return taken(format::setdest, "$node_(0) set X_ 0\n$node_(1) set X_ 0\n$ns_ at " + at +
                                      " \"$node_(1) setdest 10 0 1\"\n")
        .plan.length;
  };
  CHECK(length("5") == 10min);
  CHECK(length("3600") == 61min);
  CHECK(refused(format::setdest, "$ns_ at 9999999 \"$node_(0) setdest 10 0 1\"\n") ==
        "1:28: it would not arrive within 10000000 s");
}

TEST_CASE("two commands of one moment, and steps below a millisecond, are one corner",
          "[imports]") {
  const auto x = taken(format::setdest, "$node_(0) set X_ 0\n$node_(1) set X_ 0\n"
                                        "$ns_ at 1.0 \"$node_(1) setdest 10 0 1\"\n"
                                        "$ns_ at 1.0 \"$node_(1) setdest 0 10 1\"\n"
                                        "$ns_ at 1.0001 \"$node_(1) setdest 0 20 1\"\n");
  const auto& path = x.plan.motes.at(1).path;
  for (std::size_t i = 1; i < path.size(); ++i)
    CHECK(path[i - 1].first < path[i].first);
}

TEST_CASE("commands of one mote of setdest come in order", "[imports]") {
  CHECK(refused(format::setdest, "$ns_ at 9 \"$node_(0) setdest 1 1 1\"\n"
                                 "$ns_ at 3 \"$node_(0) setdest 2 2 1\"\n") ==
        "2:22: it comes after a later command of the same node");
}

TEST_CASE("a line of movements that is cut off is refused at its end", "[imports]") {
  CHECK(refused(format::setdest, "$node_(0) set X_") == "1:17: a coordinate is missing");
  CHECK(refused(format::setdest, "$node_(0)") == "1:10: `set` is missing");
  CHECK(refused(format::setdest, "$ns_ at 1 \"$node_(0) setdest 1 2\"") ==
        "1:34: a speed is missing");
  CHECK(refused(format::setdest, "$ns_ at 1") == "1:10: $node_(N) is missing");
}

TEST_CASE("programs in Tcl instead of movements are refused", "[imports]") {
  CHECK(refused(format::setdest, "for {set i 0} {$i < 9} {incr i} {\n").substr(0, 14) ==
        "1:1: expected ");
  CHECK(refused(format::setdest, "$node_($i) set X_ 1\n") ==
        "1:8: a node must be a number from 0 to 65000, not \"$i\"");
  CHECK(refused(format::setdest, "$node_(0) set R_ 1\n") ==
        "1:15: expected X_, Y_ or Z_, not \"R_\"");
  CHECK(refused(format::setdest, "$ns_ at 1 \"$node_(0) random-motion 1\"\n") ==
        "1:22: expected `setdest`, not \"random-motion\"");
  CHECK(refused(format::setdest, "").find("there is no mote in it") != std::string::npos);
}

TEST_CASE("numbers of movements have limits", "[imports]") {
  CHECK(refused(format::setdest, "$node_(65001) set X_ 1").find("from 0 to 65000") !=
        std::string::npos);
  CHECK(refused(format::setdest, "$node_(0) set X_ 100000.1").find("from -100000 to 100000") !=
        std::string::npos);
  CHECK(refused(format::setdest, "$ns_ at 10000001 \"$node_(0) setdest 1 1 1\"")
            .find("a time in seconds must be a number from 0 to 10000000") != std::string::npos);
  CHECK(refused(format::setdest, "$ns_ at 1 \"$node_(0) setdest 1 1 1000.5\"")
            .find("a speed in m/s must be a number from 0 to 1000") != std::string::npos);
  CHECK(refused(format::setdest, "$ns_ at -1 \"$node_(0) setdest 1 1 1\"").substr(0, 4) == "1:9:");
  taken(format::setdest, "$node_(65000) set X_ -100000\n$node_(65000) set Y_ 1e5\n");
}

TEST_CASE("a mote of setdest has a thousand corners at most", "[imports]") {
  std::string text = "$node_(0) set X_ 0\n$node_(1) set X_ 0\n";
  for (int i = 1; i <= 1200; ++i)
    text += "$ns_ at " + std::to_string(10 * i) + " \"$node_(1) setdest " +
            std::to_string(i % 2 * 10) + " 0 1\"\n";
  const auto x = taken(format::setdest, text);
  CHECK(x.plan.motes.at(1).path.size() == waypoints_max);
  CHECK(noted(x, "movements of a mote after its 1000th") == text_place{});
}
