// What motes of an island say to each other hop by hop. What decodes encodes back to the same
// octets; a mote that hears anything stays sound. The first octet chooses the kind.
#include <cstdint>
#include <cstdlib>

#include "network/am.hpp"
#include "network/channels/channels.hpp"
#include "network/clock/clock_sync.hpp"
#include "network/tree/collection.hpp"

using namespace rubicon;
using namespace rubicon::network;

namespace {

template <class Decoded>
void check(const Decoded& x, byte_view octets) {
  if (x && encode(*x) != to_bytes(octets))
    std::abort();
}

void check_round_trips(byte_view octets) {
  check(decode_up(octets), octets);
  check(decode_flood(octets), octets);
  if (const auto x = decode_down(octets); x && *decode_down(encode(*x)) != *x)
    std::abort();
  if (const auto x = decode_channel_message(octets); x && *decode_channel_message(encode(*x)) != *x)
    std::abort();
}

void hear(byte_view octets, std::uint8_t am_type) {
  collection_config config;
  config.self = mote_id{3};
  collection motes(config, random_stream(1));
  for (int i = 0; i < 2; ++i) {
    static_cast<void>(motes.on_frame(mote_id{2}, am_type, octets, instant{}));
    static_cast<void>(motes.on_sent(i == 0, instant{1s}));
  }
  static_cast<void>(motes.on_time(instant{1min}));
  channels_config with;
  with.self = mote_id{3};
  channels paths(with, random_stream(1));
  const surroundings around{virtual_coordinates{1, 2, 3}, {{mote_id{2}, {}}, {mote_id{4}, {}}}, {}};
  for (int i = 0; i < 2; ++i) {
    static_cast<void>(paths.on_frame(mote_id{2}, octets, around, instant{}));
    static_cast<void>(paths.on_sent(i == 0, {}, instant{1s}));
  }
  static_cast<void>(paths.on_time(instant{1min}));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return 0;
  const auto octets = byte_view(data, size).subspan(1);
  check_round_trips(octets);
  constexpr std::uint8_t kinds[] = {am::up, am::down, am::flood, am::channel};
  hear(octets, kinds[data[0] % 4]);
  byte_reader from(octets);
  const auto stamp = read_clock_stamp(from);
  clock_sync_config timing;
  timing.self = mote_id{3};
  clock_sync clock(timing, instant{});
  static_cast<void>(clock.on_stamp(stamp, instant{1s}));
  if (clock.time().synchronised())
    static_cast<void>(clock.time().when(clock.time().at(instant{2s})));
  return 0;
}
