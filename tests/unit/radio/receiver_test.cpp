#include "radio/medium/receiver.hpp"
#include "radio/parameters.hpp"
#include "support/catch.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::frame_for;
using test::standard;

namespace {

constexpr duration service = 2ms;
constexpr duration memory = 100ms;

/// Mote 7 of PAN 1.
struct listening_mote {
  verdict hear(const frame& x, duration at) {
    const bool addressed = x.pan == 1 && x.destination == mote_id{7};
    return inbox.on_frame(x, addressed, service, mcu, instant(at));
  }

  receiver inbox{standard, 3, memory};
  energy_meter mcu{find_platform("micaz"), 2000, 0, instant{}};
};

} // namespace

TEST_CASE("a radio holds as many frames as it has slots, each for its service time in turn",
          "[radio][receiver]") {
  listening_mote x;
  for (std::uint8_t i = 0; i < 3; ++i)
    CHECK(x.hear(frame_for(7, 1, 9, i), 1ms) == verdict::accepted);
  CHECK(x.hear(frame_for(7, 1, 9, 3), 1ms) == verdict::overflow);
  CHECK(x.hear(frame_for(7, 1, 9, 3), 3ms - 1ns) == verdict::overflow);
  CHECK(x.hear(frame_for(7, 1, 9, 3), 3ms) == verdict::accepted); // the first is served
  CHECK(x.hear(frame_for(7, 1, 9, 4), 5ms - 1ns) == verdict::overflow);
  CHECK(x.hear(frame_for(7, 1, 9, 4), 5ms) == verdict::accepted);
  CHECK(x.mcu.times(instant(20ms)).mcu_active == 5 * service);
}

TEST_CASE("a repeat is known by source and DSN", "[radio][receiver]") {
  listening_mote x;
  CHECK(x.hear(frame_for(7, 1, 9, 5), 0ms) == verdict::accepted);
  CHECK(x.hear(frame_for(7, 1, 9, 5), 10ms) == verdict::duplicate);
  CHECK(x.hear(frame_for(7, 1, 9, 5), 20ms) == verdict::duplicate);
  CHECK(x.hear(frame_for(7, 1, 8, 5), 30ms) == verdict::accepted); // another source
  CHECK(x.hear(frame_for(7, 1, 9, 6), 40ms) == verdict::accepted); // another frame
  CHECK(x.hear(frame_for(7, 1, 9, 5), 50ms) == verdict::accepted); // only the last counts
}

TEST_CASE("an old DSN is a new frame", "[radio][receiver]") {
  listening_mote x;
  CHECK(x.hear(frame_for(7, 1, 9, 5), 0ms) == verdict::accepted);
  CHECK(x.hear(frame_for(7, 1, 9, 5), memory) == verdict::duplicate);
  CHECK(x.hear(frame_for(7, 1, 9, 5), memory + 1ns) == verdict::accepted);
}

TEST_CASE("broadcasts are never repeats", "[radio][receiver]") {
  listening_mote x;
  CHECK(x.hear(frame_for(0xffff, 1, 9, 5), 0ms) == verdict::accepted);
  CHECK(x.hear(frame_for(0xffff, 1, 9, 5), 5ms) == verdict::accepted);
  CHECK(x.hear(frame_for(7, 1, 9, 5), 10ms) == verdict::accepted);
}

TEST_CASE("a restart forgets slots and repeats", "[radio][receiver]") {
  listening_mote x;
  for (std::uint8_t i = 0; i < 3; ++i)
    static_cast<void>(x.hear(frame_for(7, 1, 9, i), 0ms));
  x.inbox.reset();
  x.mcu.drop_work(instant{});
  CHECK(x.hear(frame_for(7, 1, 9, 2), 0ms) == verdict::accepted);
}

TEST_CASE("without slots nothing is received", "[radio][receiver]") {
  receiver x(standard, 0, memory);
  energy_meter mcu(find_platform("micaz"), 2000, 0, instant{});
  CHECK(x.on_frame(frame_for(7), true, service, mcu, instant{}) == verdict::overflow);
}
