// What decodes encodes back to the same octets; and octets from two channels, whatever they say,
// leave a Stream System whose table entries can all be freed.
#include <cstdlib>

#include "stream/streams.hpp"

using namespace rubicon;
using namespace rubicon::stream;

namespace {

constexpr mote_address self{island_id{1}, mote_id{2}};

/// First octet: which channel the rest arrives on, and how much is cut off for the next message.
void feed(streams& x, byte_view octets) {
  instant now{};
  while (!octets.empty()) {
    const channel_handle channel{octets[0] % 3U};
    const auto size = std::min<std::size_t>(octets[0] / 3U, octets.size() - 1);
    now += 100ms;
    static_cast<void>(x.on_channel_octets(channel, octets.subspan(1, size), now));
    octets = octets.subspan(1 + size);
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  const auto decoded = decode_message(octets);
  if (decoded && encode(*decoded) != to_bytes(octets))
    std::abort();

  streams x;
  const auto reader = x.open_remote(self, {.destination = self, .name = 7}, {}).stream;
  const auto writer =
      x.open_remote(self, {.destination = {island_id{1}, mote_id{3}}, .name = 8}, {}).stream;
  static_cast<void>(x.on_connected(writer, channel_handle{0}, {}));
  static_cast<void>(x.on_accepted(channel_handle{1}, {island_id{1}, mote_id{3}}, {}));
  static_cast<void>(x.on_accepted(channel_handle{2}, {island_id{1}, mote_id{4}}, {}));
  feed(x, octets);
  static_cast<void>(x.on_time(instant{} + 1h));
  static_cast<void>(x.close(reader));
  static_cast<void>(x.close(writer));
  if (x.open_streams() != 0 || x.early_channels() != 0 || x.deadline())
    std::abort();
  return 0;
}
