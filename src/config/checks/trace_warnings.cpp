#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <variant>

#include "config/checks/warnings.hpp"
#include "config/summary_parts.hpp"
#include "config/toml/document.hpp"

namespace rubicon::config {

namespace {

/// One series of a trace, as far as it is within the run.
struct coverage {
  std::size_t within = 0;
  duration covered{};
};

coverage coverage_of(const device::time_series& series, duration run) {
  coverage out;
  const auto last = series.back().first;
  const auto gap = series.size() > 1 ? last - series[series.size() - 2].first : duration(0);
  for (const auto& [at, value] : series)
    out.within += at >= 0s && at <= run ? 1U : 0U;
  const auto begin = std::clamp(series.front().first, duration(0), run);
  out.covered = std::max(std::min(last + gap, run) - begin, duration(0));
  return out;
}

std::string time_text(device::trace_time start, duration since_start) {
  start.since += since_start;
  return to_text(start);
}

/// `of mote 7, `; nothing in a trace without motes.
std::string mote_text(const device::trace_table& x, std::uint32_t mote) {
  return x.of_mote.size() == 1 && x.of_mote.contains(0) ? "" : " of mote " + std::to_string(mote);
}

std::string ends_text(const device::trace_time& start, const device::time_series& series,
                      duration run) {
  return "they are from " + time_text(start, series.front().first) + " to " +
         time_text(start, series.back().first) + ", the run is from " +
         time_text(start, duration(0)) + " to " + time_text(start, run) +
         "; `start` sets the time of the trace at which that begins";
}

/// What is to be said of a series; empty: nothing.
std::string warning_of(const device::trace_model& trace, std::uint32_t mote,
                       const device::trace_time& start, duration run) {
  const auto& x = *trace.table;
  const bool repeats = trace.repeats;
  const auto& series = x.of_mote.at(mote);
  const auto last = series.back().first;
  const auto length = repeats && x.turn > 0s ? std::min(x.turn, run) : run;
  const auto [within, covered] = coverage_of(series, length);
  const auto of = mote_text(x, mote);
  if (within == 0)
    return "none of its " + counted(series.size(), "reading") + of +
           " is within the run: " + ends_text(start, series, run);
  if (within == 1 && series.size() > 1 && !repeats)
    return "only one of its " + counted(series.size(), "reading") + of +
           " is within the run: " + ends_text(start, series, run);
  if (!repeats && series.size() > 1 && 2 * covered < run)
    return "its readings" + of + " cover " + to_text(covered) + " of a run of " + to_text(run) +
           (last < run ? ": the last one, of " + time_text(start, last) +
                             ", applies until the end; `repeat = true` begins again"
                       : ": the first one, of " + time_text(start, series.front().first) +
                             ", applies before");
  if (x.skipped > 0) {
    std::size_t readings = 0;
    for (const auto& [each, all] : x.of_mote)
      readings += all.size();
    if (x.skipped > readings)
      return "of its lines " + std::to_string(x.skipped) +
             " are skipped, since they lack a time, a mote or a value, or this is beyond `min` and "
             "`max`; " +
             std::to_string(readings) + " are read";
  }
  return {};
}

} // namespace

void warn_of_traces(const ecology_description& x, const file_places& seen, warning_list& out) {
  std::map<std::pair<const device::trace_table*, bool>, bool>
      reported; // one mote of a trace will do
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes)
      for (const auto& each : mote.transducers) {
        const auto* trace = std::get_if<device::trace_model>(&each.model);
        const auto place = trace == nullptr ? seen.traces.end() : seen.traces.find(trace->table);
        if (place == seen.traces.end() || reported[{trace->table.get(), trace->repeats}])
          continue;
        const auto what =
            warning_of(*trace, trace->mote.value_or(mote.id.value), place->second.start, x.length);
        if (what.empty())
          continue;
        reported[{trace->table.get(), trace->repeats}] = true;
        out.emplace_back(place->second.at,
                         "the trace " + in_quotes(place->second.file) + ": " + what);
      }
}

} // namespace rubicon::config
