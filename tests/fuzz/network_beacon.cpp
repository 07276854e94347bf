// What decodes encodes back to the same octets, and no beacon upsets who takes it in.
#include <cstdlib>

#include "network/beacon.hpp"
#include "network/clock/clock_sync.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubicon;
  using namespace rubicon::network;
  const byte_view octets(data, size);
  const auto x = decode_beacon(octets);
  if (!x)
    return 0;
  if (encode(*x) != to_bytes(octets))
    std::abort();
  const mote_id self{2};
  instant now;
  neighbours links;
  gradient tree({.self = self});
  coordinates place({.self = self, .is_sink = (x->sequence & 1) != 0}, now);
  clock_sync_config config;
  config.self = self;
  clock_sync clock(config, now);
  clock.on_stamp(x->clock, now);
  static_cast<void>(clock.time().network_time(now));
  auto report = x->report(mote_id{3}, self, false);
  for (int i = 0; i < 8; ++i) {
    now += 10s;
    ++report.sequence;
    report.hears_us = 255;
    static_cast<void>(links.on_beacon(report, now));
    static_cast<void>(tree.on_beacon(mote_id{3}, x->gradient, links));
    place.on_beacon(mote_id{3}, x->coordinates, links);
    static_cast<void>(tree.update(links, now));
    static_cast<void>(place.update(links, now));
    static_cast<void>(tree.advertise());
    static_cast<void>(place.advertise());
  }
  return 0;
}
