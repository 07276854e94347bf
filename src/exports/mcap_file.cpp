#include "exports/mcap_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/bytes.hpp"
#include "core/text/json.hpp"
#include "explain/outcome.hpp"
#include "exports/mcap_schemas.hpp"
#include "exports/mcap_writer.hpp"
#include "exports/mote_places.hpp"
#include "exports/stations.hpp"
#include "view/sample_json.hpp"

namespace rubicon::exports {

namespace {

using nlohmann::ordered_json;

/// What a message of the file is made of.
enum class source : std::uint8_t { first_places, message, tuple, event, sample };

/// One of them.
struct entry {
  instant at;
  source what = source::message;
  std::uint32_t index = 0;
};

ordered_json time_of(instant at) {
  const auto ns = at.time_since_epoch().count();
  return {{"sec", ns / 1'000'000'000}, {"nsec", ns % 1'000'000'000}};
}

ordered_json vector_of(double x, double y, double z) {
  return {{"x", x}, {"y", y}, {"z", z}};
}

ordered_json pose_of(double x, double y, double z) {
  return {{"position", vector_of(x, y, z)},
          {"orientation", {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 1}}}};
}

ordered_json colour_of(double r, double g, double b) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", 1}};
}

/// Without primitives.
ordered_json entity_of(const std::string& id, instant at) {
  ordered_json x = {{"timestamp", time_of(at)},
                    {"frame_id", "ecology"},
                    {"id", id},
                    {"lifetime", {{"sec", 0}, {"nsec", 0}}}, // until it is replaced
                    {"frame_locked", false}};
  for (const auto* const list : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                                 "triangles", "texts", "models"})
    x[list] = ordered_json::array();
  return x;
}

/// When it was known how a message ended; in flight: the end of the record.
instant ending_of(const explain::traces& all, const explain::message& x,
                  explain::message_status status) {
  if (status == explain::message_status::in_flight)
    return all.end;
  if (status == explain::message_status::delivered && x.delivered)
    return *x.delivered;
  if (x.ending)
    return x.ending->at;
  if (x.failed)
    return *x.failed;
  auto last = all.nodes[x.root].begin;
  for (const auto n : x.nodes)
    last = std::max(last, all.nodes[n].time());
  return last;
}

class file_writer {
public:
  file_writer(const explain::traces& all, const octets_out& out)
      : all_(all), file_(out), places_(places_of(all.ecology)) {
    for (const auto* const each :
         {&messages_topic, &tuples_topic, &events_topic, &places_topic, &links_topic, &scene_topic})
      channels_[each] = file_.add_channel(each->name, each->schema);
  }

  void write() {
    for (const auto& each : entries())
      add(each);
    file_.finish();
  }

private:
  /// All there is, ascending by time.
  [[nodiscard]] std::vector<entry> entries() const {
    std::vector<entry> all{{instant{}, source::first_places, 0}};
    const auto take = [&all](instant at, source what, std::size_t index) {
      all.push_back({std::max(at, instant{}), what, static_cast<std::uint32_t>(index)});
    };
    for (std::size_t i = 0; i < all_.messages.size(); ++i) {
      const auto& x = all_.messages[i];
      take(ending_of(all_, x, explain::outcome_of(all_, x).status), source::message, i);
    }
    for (std::size_t i = 0; i < all_.tuples.size(); ++i)
      take(all_.tuples[i].set.value_or(all_.tuples[i].begun(all_.nodes)), source::tuple, i);
    for (std::size_t i = 0; i < all_.events.size(); ++i)
      take(all_.events[i].time, source::event, i);
    for (std::size_t i = 0; i < all_.samples.size(); ++i)
      if (const auto x = view::decode_sample(all_.samples[i]))
        take(x->at, source::sample, i);
    std::ranges::stable_sort(all, {}, &entry::at);
    return all;
  }

  void add(const entry& x) {
    switch (x.what) {
    case source::first_places:
      return add_places(x.at, nullptr);
    case source::message:
      return put(messages_topic, x.at, message_json(all_.messages[x.index]));
    case source::tuple:
      return put(tuples_topic, x.at, tuple_json(all_.tuples[x.index]));
    case source::event:
      return put(events_topic, x.at, event_json(all_.events[x.index]));
    case source::sample:
      if (const auto sample = view::decode_sample(all_.samples[x.index])) {
        put(links_topic, x.at, links_json(*sample));
        add_places(x.at, &*sample);
      }
    }
  }

  void put(const topic& to, instant at, const ordered_json& x) {
    file_.add(channels_.at(&to), at, json_line(x));
  }

  [[nodiscard]] ordered_json message_json(const explain::message& x) const {
    const auto outcome = explain::outcome_of(all_, x);
    ordered_json y = {{"message", x.name},
                      {"from", all_.known.of(x.source)},
                      {"to", all_.known.of(x.destination)},
                      {"kind", x.is_on_channel  ? "channel"
                               : x.is_in_tunnel ? "tunnel"
                                                : "message"},
                      {"sent_s", seconds(all_.nodes[x.root].begin.time_since_epoch())},
                      {"outcome", explain::to_string(outcome.status)}};
    if (outcome.took)
      y["took_s"] = seconds(*outcome.took);
    for (const auto& [key, text] :
         {std::pair("why", &outcome.why), {"cause", &outcome.cause}, {"where", &outcome.where}})
      if (!text->empty())
        y[key] = *text;
    y["repeats"] = {{"radio", outcome.retries.radio},
                    {"serial", outcome.retries.serial},
                    {"peis", outcome.retries.peis},
                    {"transport", outcome.retries.transport}};
    return y;
  }

  [[nodiscard]] ordered_json tuple_json(const explain::tuple_value& x) const {
    return {{"key", x.key},
            {"owner", all_.known.of(x.owner)},
            {"value", x.is_text ? rubicon::to_string(byte_view(x.value)) : "0x" + to_hex(x.value)},
            {"by", explain::names::of(x.writer)},
            {"deleted", x.is_deletion}};
  }

  [[nodiscard]] ordered_json event_json(const explain::record& x) const {
    constexpr int info = 2;
    return {{"timestamp", time_of(std::max(x.time, instant{}))},
            {"level", info},
            {"message", x.text},
            {"name", station_of(all_.known, x.from)},
            {"file", ""},
            {"line", 0}};
  }

  /// Absent: what is not known.
  [[nodiscard]] ordered_json links_json(const report::run_sample& x) const {
    auto motes = ordered_json::array();
    auto neighbours = ordered_json::array();
    for (const auto& mote : x.motes) {
      const auto name = all_.known.of(mote.address);
      ordered_json y = {{"mote", name}, {"alive", mote.alive}, {"used_mah", mote.used_mah}};
      if (mote.parent != mote_id{}) {
        y["parent"] = all_.known.of(mote_address{mote.address.island, mote.parent});
        y["hops"] = mote.hops;
      }
      if (mote.signal_dbm)
        y["signal_dbm"] = *mote.signal_dbm;
      if (mote.etx)
        y["etx"] = *mote.etx;
      motes.push_back(std::move(y));
      for (const auto& each : mote.neighbours) {
        auto& link = neighbours.emplace_back(ordered_json{
            {"mote", name},
            {"neighbour", all_.known.of(mote_address{mote.address.island, each.mote})}});
        if (each.etx)
          link["etx"] = *each.etx;
      }
    }
    return {{"motes", std::move(motes)}, {"neighbours", std::move(neighbours)}};
  }

  /// @param sample nothing: none is there yet
  void add_places(instant at, const report::run_sample* sample) {
    if (places_.empty())
      return;
    std::map<mote_address, position> where;
    auto list = ordered_json::array();
    for (const auto& each : places_) {
      const auto place = each.path.at(at);
      if (!std::isfinite(place.x_m) || !std::isfinite(place.y_m))
        continue;
      where[each.who] = place;
      list.push_back({{"mote", all_.known.of(each.who)}, {"x_m", place.x_m}, {"y_m", place.y_m}});
    }
    put(places_topic, at, {{"motes", std::move(list)}});
    put(scene_topic, at, scene_json(at, where, sample));
  }

  [[nodiscard]] ordered_json scene_json(instant at, const std::map<mote_address, position>& where,
                                        const report::run_sample* sample) const {
    std::map<mote_address, bool> alive;
    auto links = ordered_json::array();
    if (sample != nullptr)
      for (const auto& mote : sample->motes) {
        alive[mote.address] = mote.alive;
        const auto here = where.find(mote.address);
        const auto parent = where.find({mote.address.island, mote.parent});
        if (here != where.end() && parent != where.end())
          for (const auto& end : {here->second, parent->second})
            links.push_back(vector_of(end.x_m, end.y_m, 0));
      }
    auto entities = ordered_json::array();
    for (const auto& [who, place] : where) {
      const auto known = alive.find(who);
      entities.push_back(mote_json(at, who, place, known == alive.end() || known->second));
    }
    entities.push_back(entity_of("links", at));
    entities.back()["lines"].push_back({{"type", 2}, // pairs of points
                                        {"pose", pose_of(0, 0, 0)},
                                        {"thickness", 1},
                                        {"scale_invariant", true},
                                        {"points", std::move(links)},
                                        {"color", colour_of(0.5, 0.5, 0.5)},
                                        {"colors", ordered_json::array()},
                                        {"indices", ordered_json::array()}});
    return {{"deletions", ordered_json::array()}, {"entities", std::move(entities)}};
  }

  [[nodiscard]] ordered_json mote_json(instant at, mote_address who, position place,
                                       bool alive) const {
    const auto name = all_.known.of(who);
    auto x = entity_of(name, at);
    x["spheres"].push_back(
        {{"pose", pose_of(place.x_m, place.y_m, 0)},
         {"size", vector_of(0.2, 0.2, 0.2)},
         {"color", alive ? colour_of(0.2, 0.6, 0.3) : colour_of(0.6, 0.2, 0.2)}});
    x["texts"].push_back({{"pose", pose_of(place.x_m, place.y_m, 0.3)},
                          {"billboard", true},
                          {"font_size", 12},
                          {"scale_invariant", true},
                          {"color", colour_of(0.5, 0.5, 0.5)},
                          {"text", name}});
    return x;
  }

  const explain::traces& all_;
  mcap_writer file_;
  std::vector<mote_place> places_;
  std::map<const topic*, mcap_writer::channel_id> channels_; ///< sought only
};

} // namespace

void write_mcap(const explain::traces& all, const octets_out& out) {
  file_writer(all, out).write();
}

} // namespace rubicon::exports
