// What decodes encodes back to the same octets; and octets from three channels, whatever they say,
// leave synaptic channels whose table entries can all be freed.
#include <cstdlib>

#include "synaptic/channels.hpp"

using namespace rubicon;
using namespace rubicon::synaptic;

namespace {

constexpr mote_address self{island_id{1}, mote_id{2}};
constexpr mote_address other{island_id{1}, mote_id{3}};

/// First octet: which channel the rest arrives on, whether the clock ticks, and how much is cut off
/// for the next message.
void feed(channels& x, byte_view octets) {
  instant now{};
  for (std::uint32_t tick = 1; !octets.empty(); octets = octets.subspan(1)) {
    const channel_handle channel{octets[0] % 3U};
    const auto size = std::min<std::size_t>(octets[0] / 6U, octets.size() - 1);
    now += 100ms;
    if (octets[0] / 3U % 2U == 0)
      static_cast<void>(x.on_tick(tick++, now));
    static_cast<void>(x.on_channel_octets(channel, octets.subspan(1, size)));
    static_cast<void>(x.on_time(now));
    octets = octets.subspan(size);
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const byte_view octets(data, size);
  const auto decoded = decode_message(octets);
  if (decoded && encode(*decoded) != to_bytes(octets))
    std::abort();

  channels x;
  const auto out = x.create_out(self, other, 3, {}, {}).channel;
  const auto in = x.create_in(self, other, 3, {}, {}).channel;
  static_cast<void>(x.on_connected(out, channel_handle{0}, {}));
  static_cast<void>(x.on_accepted(channel_handle{1}, other, {}));
  static_cast<void>(x.on_accepted(channel_handle{2}, other, {}));
  feed(x, octets);
  for (std::size_t i = 0; i < 4; ++i)
    static_cast<void>(x.read_input(in, i));
  static_cast<void>(x.start(out));
  static_cast<void>(x.on_time(instant{} + 1h));
  static_cast<void>(x.dispose(out));
  static_cast<void>(x.dispose(in));
  static_cast<void>(x.on_time(instant{} + 2h));
  if (x.open_channels() != 0 || x.early_channels() != 0 || x.deadline())
    std::abort();
  return 0;
}
