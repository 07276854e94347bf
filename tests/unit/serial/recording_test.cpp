#include <memory>
#include <string>
#include <variant>

#include "serial/host_port.hpp"
#include "serial/recording.hpp"
#include "support/catch.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using namespace rubicon::serial::test;

namespace {

const auto title = std::string(recording_title) + '\n';

std::string problem_of(const std::string& line) {
  const auto x = read_recorded(line);
  const auto* problem = std::get_if<recording_problem>(&x);
  return problem == nullptr ? "none" : problem->message;
}

std::vector<recorded_frame> frames_in(const std::string& text) {
  return std::get<0>(read_recording(text, "kitchen"));
}

} // namespace

TEST_CASE("a recorded frame reads as it was written", "[serial][ACT-08]") {
  const recorded_frame all[] = {
      {instant(12004160us),
       "kitchen",
       direction::to_pc,
       {frame_type::packet, 0, numbered_packet(9, 20)}},
      {instant(0s), "k", direction::to_mote, {frame_type::packet_with_ack, 0x7e, bytes{0}}},
      {instant(86400s), "k", direction::to_pc, {frame_type::ack, 0xff, {}}},
      {instant(1us), "k", direction::to_pc, {frame_type::unknown, 0, bytes{0x46}}},
  };
  for (const auto& x : all) {
    CAPTURE(to_text(x));
    const auto back = read_recorded(to_text(x));
    REQUIRE(std::holds_alternative<recorded_frame>(back));
    CHECK(std::get<recorded_frame>(back) == x);
  }
  CHECK(to_text(all[1]) == "0.000000 k down 44 7e 00");
}

TEST_CASE("a line that is no frame is reported with what is expected", "[serial][ACT-08]") {
  CHECK(problem_of("") == "none");
  CHECK(problem_of("# note") == "none");
  CHECK(problem_of("1.0 k up 45 00\r") == "none");
  CHECK(problem_of("soon k up 45 00").find("a time in seconds") != std::string::npos);
  CHECK(problem_of("-1 k up 45 00").find("a time in seconds") != std::string::npos);
  CHECK(problem_of("1e300 k up 45 00").find("a time in seconds") != std::string::npos);
  CHECK(problem_of("1 k left 45 00").find("`up` or `down`") != std::string::npos);
  CHECK(problem_of("1 k up 46 00").find("43, 44, 45 or ff") != std::string::npos);
  CHECK(problem_of("1 k up 44").find("sequence number") != std::string::npos);
  CHECK(problem_of("1 k up 45 0").find("in hexadecimal") != std::string::npos);
  CHECK(problem_of("1 k up 43 01 00").find("an ack has none") != std::string::npos);
  CHECK(problem_of("1 k up 45 " + std::string(514, '0')).find("at most 256") != std::string::npos);
}

TEST_CASE("of a recording what the sink of an island has said is played, in order of time",
          "[serial][ACT-08]") {
  const auto all = frames_in(title + "2.0 kitchen up 45 0002\n"
                                     "1.0 kitchen up 45 0001\n"
                                     "1.5 attic up 45 0003\n"
                                     "1.6 kitchen down 44 01 0004\n"
                                     "1.7 kitchen up 43 01\n");
  REQUIRE(all.size() == 2);
  CHECK(all[0].what.packet == bytes{0, 1});
  CHECK(all[1].what.packet == bytes{0, 2});

  const auto no_title = read_recording("1.0 kitchen up 45 0001\n", "kitchen");
  CHECK(std::get<recording_problem>(no_title).line == 1);
  const auto broken = read_recording(title + "1.0 kitchen up 45 0001\nx\n", "kitchen");
  CHECK(std::get<recording_problem>(broken).line == 3);
}

TEST_CASE("a replay says at its speed what was recorded, and acks what it is sent",
          "[serial][ACT-08]") {
  const auto all = std::make_shared<const std::vector<recorded_frame>>(
      frames_in(title + "1.0 kitchen up 45 0001\n3.0 kitchen up 45 0002\n"));
  replay x(all, 2);
  CHECK(x.deadline() == instant(500ms));
  CHECK(x.on_time(instant(499ms)).empty());
  CHECK(decode_all(x.on_time(instant(500ms))).at(0).packet == bytes{0, 1});
  CHECK(x.deadline() == instant(1500ms));
  CHECK(decode_all(x.on_time(instant(9s))).at(0).packet == bytes{0, 2});
  CHECK(!x.deadline());

  host_port pc;
  const auto written = serial::test::all<to_line>(pc.send(packet_id{1}, numbered_packet(1, 8), {}));
  CHECK(serial::test::all<sent>(pc.on_bytes(x.on_pc(written.at(0).octets), {})).size() == 1);
}
