// Sections of the report on what has become of messages, frames and groups in each island.
#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "report/figures.hpp"
#include "report/print/report_page.hpp"
#include "report/report.hpp"
#include "report/report_parts.hpp"

namespace rubicon::report {

namespace {

void add_membership_notes(table& rows, const island_report& island) {
  std::string absent;
  for (const auto& mote : island.motes)
    if (mote.joins && !mote.joined)
      absent += (absent.empty() ? "" : ", ") + mote.name;
  if (!absent.empty())
    rows.add_note("  never joined: " + absent, look::bad);
}

/// Those who have been silent for longest: `  silent: climate-7 for 8 h 24 min from 6,673 s`
void add_silence_note(table& rows, const island_report& island) {
  constexpr duration silence_min = 1min; // less is nothing that anybody would look into
  constexpr std::size_t motes_max = 5;
  std::vector<const mote_report*> all;
  for (const auto& mote : island.motes)
    if (mote.silence >= silence_min)
      all.push_back(&mote);
  std::ranges::stable_sort(all, std::greater(), [](const auto* x) { return x->silence; });
  std::string text;
  for (std::size_t i = 0; i < std::min(all.size(), motes_max); ++i)
    text += (i == 0 ? "" : ", ") + all[i]->name + " for " +
            span_text(all[i]->silence, all[i]->silence_from);
  if (all.size() > motes_max)
    text += " and " + counted(all.size() - motes_max, "more mote");
  if (!text.empty())
    rows.add_note("  silent: " + text, look::bad);
}

/// `  led by kitchen-gateway: 2 times, 512.4 s, at the end; kitchen-gateway-2: ...`
void add_lead_note(table& rows, const island_report& island) {
  std::string text;
  for (const auto& x : island.gateways) {
    text += (text.empty() ? "" : "; ") + x.name + ": " + counted(x.lead.led, "time");
    if (x.lead.led > 0)
      text += ", " + real_time(seconds(x.lead.leading));
    if (x.lead.leads)
      text += ", at the end";
  }
  if (!text.empty())
    rows.add_note("  led by " + text);
}

void add_measuring_note(table& rows, const run_report& island) {
  if (const auto count = island.motes_measuring(); count > 0)
    rows.add_note("  " + counted(count, "measuring mote"));
}

void add_loss_notes(table& rows, const island_report& island) {
  const auto add = [&](const char* where, const std::string& what) {
    if (!what.empty())
      rows.add_note(where + what);
  };
  const auto in_range = "  of " + with_thousands(island.radio.sent) + " copies in range: ";
  add(in_range.c_str(), causes(really_lost(island.radio)));
  add("  radio gave up: ", causes(island.radio.mac_failed));
  add("  lost on the cable: ", causes(island.serial.lost));
  add("  not accepted from real motes: ", causes(island.real.dropped));
  add("  not sent to real motes: ", causes(island.real.inputs_failed));
  auto messages = island.messages.lost;
  messages["in_transit"] = island.messages.in_transit;
  messages["duplicates"] = island.messages.duplicates;
  add("  messages: ", causes(messages));
  add("  messages refused: ", causes(island.messages.refused));
}

void add_island_row(table& rows, const std::string& name, const run_report& part,
                    const std::string& id) {
  const auto radio = part.radio();
  const auto messages = part.messages();
  const auto alive = part.motes_alive();
  const auto motes = part.motes_configured() + part.motes_measuring();
  const bool only_measures = part.motes_configured() == 0 && motes > 0;
  rows.add({{name, look::strong},
            id,
            with_thousands(motes),
            only_measures ? "–" : with_thousands(part.motes_joined()),
            {with_thousands(alive), alive < motes ? look::bad : look::plain},
            with_thousands(messages.reliable_sent + messages.unreliable_sent),
            with_thousands(messages.arrived),
            share_of(messages.reliable_acked, messages.reliable_sent - messages.reliable_open),
            with_thousands(radio.requests),
            share_of(radio.mac_sent, radio.requests - radio.mac_open),
            with_thousands(part.serial().frames_received)});
}

std::string microseconds_text(duration x) {
  return with_thousands(static_cast<std::uint64_t>(x / 1us)) + " µs";
}

/// `  clocks: at worst 1,204 µs off, c2 at 10:40; 99.8% of 1,200 judgements below 1 ms, none
/// outside what motes say`
void add_clock_note(table& rows, const clock_report& x) {
  if (x.judged == 0)
    return;
  auto text = "  clocks: at worst " + microseconds_text(x.error_max) + " off, " + x.error_max_mote +
              " at " + clock_text(x.error_max_at.time_since_epoch()) + "; " +
              percent(static_cast<double>(x.below_1ms), static_cast<double>(x.judged)) + " of " +
              counted(x.judged, "judgement") + " below 1 ms, ";
  if (x.outside == 0)
    text += "none outside the motes' own error bounds";
  else
    text += with_thousands(x.outside) + " outside the motes' own error bounds, for " +
            real_time(seconds(x.outside_longest)) + " at most";
  rows.add_note(text, x.outside > 0 ? look::bad : look::faint);
}

} // namespace

void add_islands(report_page& page, const run_report& x) {
  if (x.islands.empty())
    return;
  page.heading("Islands", "what became of messages and radio frames");
  table rows({{"island"},
              {"id", align::right},
              {"motes", align::right},
              {"joined", align::right},
              {"alive", align::right},
              {"messages", align::right},
              {"arrived", align::right},
              {"acked", align::right},
              {"frames", align::right},
              {"sent", align::right},
              {"serial", align::right}});
  const auto shown = page.shown(x.islands.size(), rows_max);
  for (std::size_t i = 0; i < shown; ++i) {
    run_report alone;
    alone.islands.push_back(x.islands[i]);
    add_island_row(rows, page.named(config::label_table::kind::island, x.islands[i].name), alone,
                   to_string(x.islands[i].id));
    add_membership_notes(rows, x.islands[i]);
    add_silence_note(rows, x.islands[i]);
    add_measuring_note(rows, alone);
    add_lead_note(rows, x.islands[i]);
    add_loss_notes(rows, x.islands[i]);
  }
  page.add_rest(rows, x.islands.size(), shown);
  if (x.islands.size() > 1)
    add_island_row(rows, "all", x, "");
  page.add(rows);
}

void add_network(report_page& page, const run_report& x) {
  const auto has_network = [](const island_report& island) { return island.network.beacons > 0; };
  if (std::ranges::none_of(x.islands, has_network))
    return;
  page.heading("Network", "how packets reach the sink, and how exact clocks are");
  table rows({{"island"},
              {"hops", align::right},
              {"packets", align::right},
              {"arrived", align::right},
              {"forwarded", align::right},
              {"channels", align::right},
              {"carried", align::right},
              {"beacons", align::right},
              {"clock ±", align::right},
              {"time ±", align::right},
              {"state", align::right}});
  const auto shown = page.shown(x.islands.size(), rows_max);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& part = x.islands[i].network;
    rows.add({{x.islands[i].name, look::strong},
              with_thousands(part.hops_max),
              with_thousands(part.packets),
              with_thousands(part.arrived),
              with_thousands(part.forwarded),
              with_thousands(part.channels_opened),
              with_thousands(part.channel_packets.arrived),
              with_thousands(part.beacons),
              part.synchronised > 0 ? microseconds_text(part.clock_error_max) : "–",
              part.aligned > 0 ? microseconds_text(part.time_error_max) : "–",
              with_thousands(part.state_octets) + " B"});
    if (const auto lost = causes(part.lost); !lost.empty())
      rows.add_note("  lost: " + lost);
    add_clock_note(rows, x.islands[i].clock);
  }
  page.add_rest(rows, x.islands.size(), shown);
  page.add(rows);
}

void add_groups(report_page& page, const run_report& x) {
  std::vector<const island_report*> all;
  for (const auto& island : x.islands)
    if (island.smepp.programs > 0)
      all.push_back(&island);
  if (all.empty())
    return;
  page.heading("Groups", "members of SMEPP groups and their events");
  table rows({{"island"},
              {"members", align::right},
              {"frames", align::right},
              {"octets", align::right},
              {"events", align::right},
              {"received", align::right},
              {"open", align::right},
              {"missing", align::right},
              {"state", align::right}});
  const auto shown = page.shown(all.size(), rows_max);
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& part = all[i]->smepp;
    rows.add({{all[i]->name, look::strong},
              with_thousands(part.members) + " of " + with_thousands(part.programs),
              with_thousands(part.frames),
              with_thousands(part.octets),
              with_thousands(part.events_raised),
              with_thousands(part.events_received),
              with_thousands(part.events_open),
              with_thousands(part.events_missing()),
              with_thousands(part.state_octets) + " B"});
    if (const auto lost = causes(part.events_lost); !lost.empty())
      rows.add_note("  events lost: " + lost);
    if (const auto refused = causes(part.refused); !refused.empty())
      rows.add_note("  frames refused: " + refused);
  }
  page.add_rest(rows, all.size(), shown);
  page.add(rows);
}

} // namespace rubicon::report
