#include "view/report_sample.hpp"

#include <algorithm>

#include "report/report_parts.hpp"

namespace rubicon::view {

namespace {

report::mote_sample sample_of(const report::mote_report& x) {
  report::mote_sample y;
  y.address = x.address;
  y.alive = x.alive;
  y.flat = !x.alive && x.left_cause == "battery";
  y.joined = x.alive && (!x.joins || (x.joined && x.left_cause.empty()));
  y.radio_on = true; // a report does not contain it
  y.used_mah = x.energy.used_mah;
  y.battery_mah = x.energy.battery_mah;
  y.parent = x.parent;
  y.hops = x.hops;
  y.signal_dbm = x.signal_dbm;
  y.delivery = x.messages.delivery();
  return y;
}

} // namespace

report::run_sample sample_of(const report::run_report& x) {
  report::run_sample y;
  y.at = instant{} + x.simulated;
  for (const auto& island : x.islands) {
    y.islands.push_back({island.id,
                         {{"radio", report::really_lost(island.radio)},
                          {"mac", island.radio.mac_failed},
                          {"network", island.network.lost},
                          {"channels", island.network.channel_packets.lost},
                          {"messages", island.messages.lost}}});
    for (const auto& mote : island.motes)
      y.motes.push_back(sample_of(mote));
  }
  std::ranges::sort(y.motes, {}, &report::mote_sample::address);
  return y;
}

} // namespace rubicon::view
