#include "radio/parameters.hpp"
#include "radio/receiver.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

constexpr duration service = 2ms;
constexpr duration memory = 100ms;

frame frame_for(std::uint16_t destination, std::uint16_t pan = 1, std::uint16_t source = 9,
                std::uint8_t dsn = 0) {
  frame x;
  x.destination = mote_id{destination};
  x.pan = pan;
  x.source = mote_id{source};
  x.dsn = dsn;
  return x;
}

struct fixture {
  verdict hear(const frame& x, duration at) { return inbox.on_frame(x, service, mcu, instant(at)); }

  receiver inbox{mote_id{7}, 1, false, 3, memory};
  energy_meter mcu{find_platform("micaz"), 2000, instant{}};
};

} // namespace

TEST_CASE("the filter passes own and broadcast frames of the own PAN",
          "[radio][receiver][RTG-06]") {
  struct passing {
    std::uint16_t destination;
    std::uint16_t pan;
    bool own;
    bool any;
  };
  for (const auto& [destination, pan, own, any] : {passing{7, 1, true, true},
                                                   {0xffff, 1, true, true},
                                                   {8, 1, false, true},
                                                   {7, 2, false, true},
                                                   {0xffff, 2, false, true},
                                                   {8, 2, false, true},
                                                   {7, 0xffff, false, true}}) {
    INFO(destination << " in " << pan);
    for (const bool promiscuous : {false, true}) {
      receiver x(mote_id{7}, 1, promiscuous, 3, memory);
      energy_meter mcu(find_platform("micaz"), 2000, instant{});
      const auto judged = x.on_frame(frame_for(destination, pan), service, mcu, instant{});
      CHECK((judged == verdict::accepted) == (promiscuous ? any : own));
      CHECK((judged == verdict::filtered) == !(promiscuous ? any : own));
      CHECK(x.addressed(frame_for(destination, pan)) == (destination == 7 && pan == 1));
    }
  }
}

TEST_CASE("a radio holds as many frames as it has slots, each for its service time in turn",
          "[radio][receiver]") {
  fixture x;
  for (std::uint8_t i = 0; i < 3; ++i)
    CHECK(x.hear(frame_for(7, 1, 9, i), 1ms) == verdict::accepted);
  CHECK(x.hear(frame_for(7, 1, 9, 3), 1ms) == verdict::overflow);
  CHECK(x.hear(frame_for(8), 1ms) == verdict::filtered); // takes no slot, needs none
  CHECK(x.hear(frame_for(7, 1, 9, 3), 3ms - 1ns) == verdict::overflow);
  CHECK(x.hear(frame_for(7, 1, 9, 3), 3ms) == verdict::accepted); // the first is served
  CHECK(x.hear(frame_for(7, 1, 9, 4), 5ms - 1ns) == verdict::overflow);
  CHECK(x.hear(frame_for(7, 1, 9, 4), 5ms) == verdict::accepted);
  CHECK(x.mcu.times(instant(20ms)).mcu_active == 5 * service);
}

TEST_CASE("a repeat is known by source and DSN", "[radio][receiver]") {
  fixture x;
  CHECK(x.hear(frame_for(7, 1, 9, 5), 0ms) == verdict::accepted);
  CHECK(x.hear(frame_for(7, 1, 9, 5), 10ms) == verdict::duplicate);
  CHECK(x.hear(frame_for(7, 1, 9, 5), 20ms) == verdict::duplicate);
  CHECK(x.hear(frame_for(7, 1, 8, 5), 30ms) == verdict::accepted); // another source
  CHECK(x.hear(frame_for(7, 1, 9, 6), 40ms) == verdict::accepted); // another frame
  CHECK(x.hear(frame_for(7, 1, 9, 5), 50ms) == verdict::accepted); // only the last counts
}

TEST_CASE("an old DSN is a new frame", "[radio][receiver]") {
  fixture x;
  CHECK(x.hear(frame_for(7, 1, 9, 5), 0ms) == verdict::accepted);
  CHECK(x.hear(frame_for(7, 1, 9, 5), memory) == verdict::duplicate);
  CHECK(x.hear(frame_for(7, 1, 9, 5), memory + 1ns) == verdict::accepted);
}

TEST_CASE("broadcasts are never repeats", "[radio][receiver]") {
  fixture x;
  CHECK(x.hear(frame_for(0xffff, 1, 9, 5), 0ms) == verdict::accepted);
  CHECK(x.hear(frame_for(0xffff, 1, 9, 5), 5ms) == verdict::accepted);
  CHECK(x.hear(frame_for(7, 1, 9, 5), 10ms) == verdict::accepted);
}

TEST_CASE("a restart forgets slots and repeats", "[radio][receiver]") {
  fixture x;
  for (std::uint8_t i = 0; i < 3; ++i)
    static_cast<void>(x.hear(frame_for(7, 1, 9, i), 0ms));
  x.inbox.reset();
  x.mcu.drop_work(instant{});
  CHECK(x.hear(frame_for(7, 1, 9, 2), 0ms) == verdict::accepted);
}

TEST_CASE("without slots nothing is received", "[radio][receiver]") {
  receiver x(mote_id{7}, 1, false, 0, memory);
  energy_meter mcu(find_platform("micaz"), 2000, instant{});
  CHECK(x.on_frame(frame_for(7), service, mcu, instant{}) == verdict::overflow);
}
