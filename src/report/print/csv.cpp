#include "report/print/csv.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/decimal.hpp"

namespace rubicon::report {

namespace {

/// The shortest text that reads back as the same number; empty if it is not finite.
std::string time_s(instant x) {
  return shortest_decimal(seconds(x.time_since_epoch()));
}

void add_field(std::string& line, std::string_view x) {
  if (x.find_first_of(",\"\r\n") == std::string_view::npos) {
    line += x;
    return;
  }
  line += '"';
  for (const char c : x)
    line.append(c == '"' ? 2 : 1, c);
  line += '"';
}

} // namespace

std::string csv_field(std::string_view x) {
  std::string field;
  add_field(field, x);
  return field;
}

std::string csv_line(std::initializer_list<std::string_view> fields) {
  std::string line;
  for (const auto x : fields) {
    add_field(line, x);
    line += ',';
  }
  line.back() = '\n';
  return line;
}

csv_tables::csv_tables(const config::ecology_description& names) {
  for (const auto& island : names.islands) {
    auto& x = names_[island.id];
    x.island = island.name;
    x.sink = island.sink.id;
    for (const auto& mote : island.motes)
      x.motes[mote.id] = mote.name;
  }
}

std::string_view csv_tables::name(kind x) {
  switch (x) {
  case kind::energy:
    return "energy";
  case kind::links:
    return "links";
  case kind::losses:
    return "losses";
  case kind::places:
    return "places";
  case kind::tuples:
    return "tuples";
  case kind::events:
    return "events";
  }
  return {};
}

std::string csv_tables::header(kind x) {
  switch (x) {
  case kind::energy:
    return "time_s,island,mote,alive,used_mah,left_percent\n";
  case kind::links:
    return "time_s,island,mote,parent,hops,signal_dbm,etx\n";
  case kind::losses:
    return "time_s,island,layer,cause,lost\n";
  case kind::places:
    return "time_s,what,cause,place,lost\n";
  case kind::tuples:
    return "time_s,peer,owner,key,value,deleted\n";
  case kind::events:
    return "time_s,who,what\n";
  }
  return {};
}

const std::string& csv_tables::island_of(island_id x) const {
  static const std::string unknown;
  const auto found = names_.find(x);
  return found == names_.end() ? unknown : found->second.island;
}

/// A mote that the fault plan has brought from another island has no name here.
std::string csv_tables::mote_of(island_id island, mote_id x) const {
  const auto found = names_.find(island);
  if (found == names_.end())
    return to_string(x);
  if (x == found->second.sink)
    return "sink";
  const auto mote = found->second.motes.find(x);
  return mote == found->second.motes.end() ? to_string(x) : mote->second;
}

std::string csv_tables::energy(const run_sample& x) const {
  std::string rows;
  for (const auto& mote : x.motes)
    rows += csv_line({time_s(x.at), island_of(mote.address.island),
                      mote_of(mote.address.island, mote.address.mote), mote.alive ? "1" : "0",
                      shortest_decimal(mote.used_mah),
                      shortest_decimal(100 * std::max(1 - mote.used_mah / mote.battery_mah, 0.0))});
  return rows;
}

std::string csv_tables::links(const run_sample& x) const {
  std::string rows;
  for (const auto& mote : x.motes) {
    const bool routed = mote.parent != mote_id{};
    rows += csv_line({time_s(x.at), island_of(mote.address.island),
                      mote_of(mote.address.island, mote.address.mote),
                      routed ? mote_of(mote.address.island, mote.parent) : std::string(),
                      routed ? std::to_string(mote.hops) : std::string(),
                      mote.signal_dbm ? std::to_string(*mote.signal_dbm) : std::string(),
                      mote.etx ? shortest_decimal(*mote.etx) : std::string()});
  }
  return rows;
}

std::string csv_tables::losses(const run_sample& x) const {
  std::string rows;
  for (const auto& island : x.islands)
    for (const auto& [layer, lost] : island.lost)
      for (const auto& [cause, count] : lost)
        rows +=
            csv_line({time_s(x.at), island_of(island.island), layer, cause, std::to_string(count)});
  for (const auto& [cause, count] : x.peis_lost)
    rows += csv_line({time_s(x.at), "", "peis", cause, std::to_string(count)});
  return rows;
}

std::string csv_tables::places(const run_sample& x) {
  std::string rows;
  for (const auto& each : x.places)
    rows += csv_line({time_s(x.at), each.what, each.cause, each.place, std::to_string(each.count)});
  return rows;
}

std::string csv_tables::row(const tuple_write& x) {
  return csv_line({time_s(x.at), x.peer, x.owner, x.key, x.value, x.deleted ? "1" : "0"});
}

std::string csv_tables::row(const logged_event& x) {
  return csv_line({time_s(x.at), x.who, x.what});
}

} // namespace rubicon::report
