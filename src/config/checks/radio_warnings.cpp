#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "config/checks/connectivity.hpp"
#include "config/checks/warnings.hpp"
#include "config/toml/document.hpp"
#include "core/numbers/math.hpp"
#include "radio/medium/tossim_files.hpp"

namespace rubicon::config {

namespace {

/// Within which what is drawn for a link stays, in deviations.
constexpr double deviations_max = 3;
/// Where the receiver's noise decides, a frame now and then comes through below its sensitivity.
constexpr double soft_edge_db = 3;

struct station {
  mote_address who;
  position place;
  const std::vector<waypoint>* path = nullptr; ///< not empty: it moves
  double transmit_dbm = 0;
  double sensitivity_dbm = 0;
  std::uint8_t channel = radio::default_channel;
  bool is_sink = false; ///< of its island, the first or a further one

  [[nodiscard]] bool moves() const { return path != nullptr && !path->empty(); }
};

template <class Node>
station station_of(island_id island, const Node& x, const radio::channel_config& radio) {
  return {{island, x.id},
          x.place,
          nullptr,
          x.transmit_dbm.value_or(x.platform->transmit_dbm_max()),
          radio.sensitivity_dbm.value_or(x.platform->sensitivity_dbm)};
}

std::string shown_m(double x) {
  return shown(std::round(x * 10) / 10) + " m";
}

double distance_m(const position& a, const position& b) {
  return math::length(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

/// From a place to a straight line between two others.
double distance_m(const position& x, const position& a, const position& b) {
  const position way{b.x_m - a.x_m, b.y_m - a.y_m, b.z_m - a.z_m};
  const auto square = way.x_m * way.x_m + way.y_m * way.y_m + way.z_m * way.z_m;
  const auto along =
      (x.x_m - a.x_m) * way.x_m + (x.y_m - a.y_m) * way.y_m + (x.z_m - a.z_m) * way.z_m;
  const auto share = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
  return distance_m(x, {a.x_m + share * way.x_m, a.y_m + share * way.y_m, a.z_m + share * way.z_m});
}

/// Their least distance; not computed for two that both move.
double nearest_m(const station& a, const station& b) {
  if (a.moves() && b.moves())
    return 0;
  if (b.moves())
    return nearest_m(b, a);
  if (!a.moves())
    return distance_m(a.place, b.place);
  auto least = distance_m(a.path->front().place, b.place);
  for (std::size_t i = 1; i < a.path->size(); ++i)
    least = std::min(least, distance_m(b.place, (*a.path)[i - 1].place, (*a.path)[i].place));
  return least;
}

/// What is lost on the way, with the luck of the draw: at `deviations` of what is drawn. [dB]
double loss_db(const radio::propagation& x, double far_m, double deviations) {
  if (const auto* disk = std::get_if<radio::unit_disk>(&x))
    return far_m <= disk->range_m ? 0 : std::numeric_limits<double>::infinity();
  if (const auto* law = std::get_if<radio::log_distance>(&x))
    return law->reference_db + 10 * law->exponent * std::log10(std::max(far_m, 1.0)) -
           deviations * (law->shadowing_db + law->asymmetry_db);
  if (const auto* friis = std::get_if<radio::friis>(&x)) {
    constexpr double light_m_s = 299'792'458;
    constexpr double pi = 3.14159265358979323846;
    const auto ratio = 4 * pi * far_m * friis->frequency_mhz * 1e6 / light_m_s;
    return std::max(0.0, 20 * std::log10(std::max(ratio, 1e-9)));
  }
  return std::numeric_limits<double>::infinity();
}

/// How far a frame is received that nothing disturbs. [m]
double range_m(const radio::propagation& x, double budget_db, double deviations) {
  double least = 0;
  double most = 1e7;
  if (loss_db(x, most, deviations) <= budget_db)
    return most;
  for (int i = 0; i < 60; ++i) { // the loss grows with the distance
    const auto middle = (least + most) / 2;
    (loss_db(x, middle, deviations) <= budget_db ? least : most) = middle;
  }
  return least;
}

/// Which links there may be, at best.
class possible_links {
public:
  explicit possible_links(const radio::channel_config& radio)
      : radio_(radio), edge_db_(radio.edge == radio::sensitivity_edge::noise ? soft_edge_db : 0) {
    for (const auto& each : radio.links) {
      if (each.gain_db)
        gains_[{each.from, each.to}] = *each.gain_db;
      if (each.loss)
        losses_[{each.from, each.to}] = *each.loss;
    }
  }

  /// How strongly a frame arrives at best. [dBm]
  [[nodiscard]] double arriving_dbm(const station& from, const station& to) const {
    constexpr auto never = -std::numeric_limits<double>::infinity();
    const std::pair link(from.who, to.who);
    const auto lost = losses_.find(link);
    if ((lost == losses_.end() ? radio_.loss : lost->second) >= 1)
      return never;
    if (const auto given = gains_.find(link); given != gains_.end())
      return from.transmit_dbm + given->second;
    if (const auto* table = std::get_if<radio::gain_matrix>(&radio_.propagation))
      return from.transmit_dbm + gain_db(*table, from, to).value_or(never);
    return from.transmit_dbm - loss_db(radio_.propagation, nearest_m(from, to), deviations_max);
  }

  [[nodiscard]] bool hears(const station& from, const station& to) const {
    return from.channel == to.channel && arriving_dbm(from, to) >= to.sensitivity_dbm - edge_db_;
  }
  [[nodiscard]] bool both_hear(const station& a, const station& b) const {
    return hears(a, b) && hears(b, a);
  }

private:
  static std::optional<double> gain_db(const radio::gain_matrix& x, const station& from,
                                       const station& to) {
    if (from.who.mote.value < x.first_mote || to.who.mote.value < x.first_mote)
      return std::nullopt;
    const std::pair link(from.who.mote.value - x.first_mote, to.who.mote.value - x.first_mote);
    const auto& all = x.table->gains;
    const auto found = std::ranges::lower_bound(
        all, link, {}, [](const auto& y) { return std::pair<int, int>(y.from, y.to); });
    if (found == all.end() || std::pair<int, int>(found->from, found->to) != link)
      return std::nullopt;
    return found->db;
  }

  const radio::channel_config& radio_;
  double edge_db_;
  std::map<std::pair<mote_address, mote_address>, double> gains_;
  std::map<std::pair<mote_address, mote_address>, double> losses_;
};

/// The sink first, then the motes.
std::vector<station> stations_of(const island_description& x, const radio::channel_config& radio) {
  std::vector<station> all{station_of(x.id, x.sink, radio)};
  all.back().channel = x.channel;
  all.back().is_sink = true;
  for (const auto& mote : x.motes) {
    all.push_back(station_of(x.id, mote, radio));
    all.back().path = &mote.path;
    all.back().is_sink = mote.backbone.has_value();
    all.back().channel = channel_of(x, mote);
  }
  return all;
}

/// Those to whom, and from whom, no chain of links leads from a sink.
std::vector<std::size_t> unreached(const std::vector<station>& all, const possible_links& links) {
  std::vector<std::size_t> left;
  std::vector<std::size_t> reached;
  for (std::size_t i = 0; i < all.size(); ++i)
    (all[i].is_sink ? reached : left).push_back(i);
  for (std::size_t i = 0; i < reached.size() && !left.empty(); ++i)
    std::erase_if(left, [&](std::size_t each) {
      const bool near = links.both_hear(all[reached[i]], all[each]);
      if (near)
        reached.push_back(each);
      return near;
    });
  return left;
}

/// The same of very many, who are looked at as if all had the best radio among them.
std::vector<std::size_t> unreached_of_many(const std::vector<station>& all,
                                           const radio::channel_config& radio) {
  double budget_db = 0;
  std::vector<position> places;
  std::vector<position> sinks;
  for (const auto& each : all) {
    if (each.moves())
      return {};
    budget_db = std::max(budget_db, each.transmit_dbm - each.sensitivity_dbm);
    places.push_back(each.place);
    if (each.is_sink)
      sinks.push_back(each.place);
  }
  return disconnected_from_any(
      sinks, places, range_m(radio.propagation, budget_db + soft_edge_db, deviations_max));
}

class radio_warnings {
public:
  radio_warnings(const ecology_description& x, const file_places& seen, warning_list& out)
      : all_(x), seen_(seen), out_(out), links_(x.radio) {}

  void look_at(const island_description& x) {
    const bool has_radios = !x.outside.has_sink() && !x.motes.empty();
    const auto* table = std::get_if<radio::gain_matrix>(&all_.radio.propagation);
    if (!has_radios || (table != nullptr && table->table == nullptr))
      return;
    for (const auto& mote : x.motes)
      look_at_walk(x, mote);
    look_at_channels(x);
    const bool is_disk = std::holds_alternative<radio::unit_disk>(all_.radio.propagation);
    if (is_disk || x.stack != stack::full) // of a disk it is a mistake: island_motes
      return;
    constexpr std::size_t exact_max = 3000;
    const auto stations = stations_of(x, all_.radio);
    const auto lost = stations.size() <= exact_max || table != nullptr || !all_.radio.links.empty()
                          ? unreached(stations, links_)
                          : unreached_of_many(stations, all_.radio);
    for (const auto i : lost)
      if (stations[i].channel == x.channel) // look_at_channels() warns of others
        tell_unreached(x, stations, lost, i);
  }

private:
  /// A mote on a channel of its own, and one that cannot hear its sink.
  void look_at_channels(const island_description& island) {
    std::map<std::uint8_t, std::size_t> radios{{island.channel, 1}};
    for (const auto& mote : island.motes)
      ++radios[channel_of(island, mote)];
    for (const auto& mote : island.motes) {
      const auto channel = channel_of(island, mote);
      const bool is_alone = radios[channel] == 1;
      if (channel == island.channel || (!is_alone && island.stack == stack::mac))
        continue;
      const auto place = seen_.motes.find({island.id, mote.id});
      const auto at = place == seen_.motes.end() ? mark() : place->second.at;
      if (reported_.insert(at).second)
        out_.emplace_back(
            at,
            "mote `" + mote.name +
                (is_alone ? "` cannot reach any radio of its island: no other one is on channel "
                          : "` cannot reach its sink: it is on channel ") +
                std::to_string(channel) +
                (is_alone ? "" : ", the sink on " + std::to_string(island.channel)));
    }
  }

  void tell_unreached(const island_description& island, const std::vector<station>& all,
                      const std::vector<std::size_t>& lost, std::size_t i) {
    const auto place = seen_.motes.find(all[i].who);
    const auto at = place == seen_.motes.end() ? mark() : place->second.at;
    if (!reported_.insert(at).second) // one mote of a group will do
      return;
    const auto who = "mote `" + island.motes[i - 1].name + "` cannot join";
    if (std::holds_alternative<radio::gain_matrix>(all_.radio.propagation)) {
      out_.emplace_back(at, who + ": no links of the topology lead to its sink and back that are "
                                  "strong enough");
      return;
    }
    double best_dbm = -std::numeric_limits<double>::infinity();
    std::size_t nearest = 0;
    for (std::size_t j = 0; j < all.size(); ++j) {
      const auto dbm =
          std::ranges::binary_search(lost, j)
              ? -std::numeric_limits<double>::infinity()
              : std::min(links_.arriving_dbm(all[i], all[j]), links_.arriving_dbm(all[j], all[i]));
      if (dbm > best_dbm) {
        best_dbm = dbm;
        nearest = j;
      }
    }
    const auto whom =
        nearest == 0 ? std::string("the sink") : "`" + island.motes[nearest - 1].name + '`';
    out_.emplace_back(at, who + ": of all radios with a route to the sink it is received best by " +
                              whom + ", " + shown_m(nearest_m(all[i], all[nearest])) +
                              " away, where its frames arrive with " + shown(std::round(best_dbm)) +
                              " dBm at most, and " + shown(all[nearest].sensitivity_dbm) +
                              " are needed");
  }

  /// A place that is brought up to date too seldom: links come and go unseen.
  void look_at_walk(const island_description& island, const mote_description& mote) {
    constexpr double share_max = 0.1;
    double fastest_m_s = 0;
    for (std::size_t i = 1; i < mote.path.size(); ++i)
      fastest_m_s = std::max(fastest_m_s, distance_m(mote.path[i - 1].place, mote.path[i].place) /
                                              seconds(mote.path[i].at - mote.path[i - 1].at));
    if (fastest_m_s == 0 || std::holds_alternative<radio::gain_matrix>(all_.radio.propagation))
      return;
    const auto radio = station_of(island.id, mote, all_.radio);
    const auto range =
        range_m(all_.radio.propagation, radio.transmit_dbm - radio.sensitivity_dbm, 0);
    const auto way_m = fastest_m_s * seconds(mote.step);
    constexpr double rounding = 1 + 1e-6;
    if (way_m <= share_max * range * rounding)
      return;
    const auto ms = std::max(std::floor(share_max * range / fastest_m_s * 100) * 10, 10.0);
    const auto place = seen_.motes.find({island.id, mote.id});
    out_.emplace_back(place == seen_.motes.end() ? mark() : place->second.walk,
                      "mote `" + mote.name + "` moves up to " + shown_m(way_m) +
                          " between two updates of its position, every " + to_text(mote.step) +
                          ", and the range of a radio is " + shown_m(range) + ": a `step` of " +
                          to_text(std::chrono::milliseconds(static_cast<std::int64_t>(ms))) +
                          " would be a tenth of that");
  }

  const ecology_description& all_;
  const file_places& seen_;
  warning_list& out_;
  possible_links links_;
  std::set<mark> reported_;
};

} // namespace

void warn_of_radios(const ecology_description& x, const file_places& seen, warning_list& out) {
  radio_warnings found(x, seen, out);
  for (const auto& each : x.islands)
    found.look_at(each);
}

} // namespace rubicon::config
