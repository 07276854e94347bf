#include "radio/medium/topology.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/hash.hpp"
#include "core/numbers/math.hpp"
#include "radio/medium/tossim_files.hpp"

namespace rubicon::radio {

namespace {

constexpr double deviations_max = 3;
constexpr double pi = 3.14159265358979323846;
constexpr double light_m_per_s = 299792458;

/// A rounding error must not take a dB off: -70 is not -71.
constexpr double rssi_tolerance_db = 1e-6;

double distance_m(const position& a, const position& b) {
  return math::length(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

bool share_channel(const site& a, const site& b) {
  return a.channel == b.channel || a.channel == all_channels || b.channel == all_channels;
}

hearers::iterator lower_bound(hearers& list, radio_index radio) {
  return std::lower_bound(list.begin(), list.end(), radio,
                          [](const hearer& x, radio_index y) { return x.radio < y; });
}

std::uint32_t number(std::uint32_t x) {
  return x;
}

std::uint32_t number(const hearer& x) {
  return x.radio.value;
}

/// Ascending by radio, each once.
template <class Radio>
void sort_out(std::vector<Radio>& all) {
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return number(a) < number(b); });
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

std::uint16_t in_65535ths(double chance) {
  assert(chance >= 0 && chance <= 1);
  return static_cast<std::uint16_t>(std::lround(chance * 65535));
}

// -------------------------------------------------------------------------------------------
// random numbers

std::uint64_t key(const mote_address& x) {
  return std::uint64_t{x.island.value} << 16U | x.mote.value;
}

/// A normal deviate between -deviations_max and deviations_max.
double cut_off_normal(const fold64& hash) {
  constexpr auto beyond = 0.00134989803163009453; // chance of less than -deviations_max
  const auto unit = static_cast<double>(hash.value() >> 11U) * 0x1p-53;
  return math::normal_quantile(beyond + unit * (1 - 2 * beyond));
}

/// The same for both directions.
double shared_deviate(std::uint64_t seed, const mote_address& a, const mote_address& b) {
  const auto [low, high] = std::minmax({key(a), key(b)});
  return cut_off_normal(fold64(seed).add(low).add(high).add("both"));
}

double own_deviate(std::uint64_t seed, const mote_address& from, const mote_address& to) {
  return cut_off_normal(fold64(seed).add(key(from)).add(key(to)).add("one"));
}

// ------------------------------------------------------------------------------------ propagation

double loss_db(const log_distance& law, double d) {
  return law.reference_db + 10 * law.exponent * math::log10(std::max(d, 1.0));
}

double loss_at_1m_db(const friis& law) {
  return 2 * to_db(4 * pi * law.frequency_mhz * 1e6 / light_m_per_s);
}

/// The distance at which `budget_db` are lost.
double spanned_m(const log_distance& law, double budget_db) {
  if (law.exponent <= 0)
    return std::numeric_limits<double>::infinity();
  return std::max(1.0, from_db((budget_db - law.reference_db) / law.exponent));
}

double reach_of(const propagation& law, double transmit_dbm, double cutoff_dbm) {
  const auto budget_db = transmit_dbm - cutoff_dbm;
  double reach_m = 0;
  if (const auto* disk = std::get_if<unit_disk>(&law))
    return disk->range_m;
  if (const auto* x = std::get_if<log_distance>(&law))
    reach_m = spanned_m(*x, budget_db + deviations_max * (x->shadowing_db + x->asymmetry_db));
  else if (const auto* y = std::get_if<friis>(&law))
    reach_m = from_db((budget_db - loss_at_1m_db(*y)) / 2);
  return std::min(reach_m * (1 + 1e-9), 1e100); // more than any rounding error; still finite
}

bool before(const gain_table::gain& x, std::pair<std::uint16_t, std::uint16_t> link) {
  return std::pair(x.from, x.to) < link;
}

std::optional<double> gain_db(const gain_table& table, std::uint16_t from, std::uint16_t to) {
  const std::pair link(from, to);
  const auto x = std::lower_bound(table.gains.begin(), table.gains.end(), link, before);
  if (x == table.gains.end() || std::pair(x->from, x->to) != link)
    return std::nullopt;
  return x->db;
}

} // namespace

topology::topology(const channel_config& config, std::uint64_t seed)
    : config_(config), seed_(seed), errors_(config.curve) {
  if (std::holds_alternative<gain_matrix>(config_.propagation))
    use_table();
  use_overrides();
}

void topology::use_table() {
  const auto& table = std::get<gain_matrix>(config_.propagation).table;
  assert(table);
  gains_by_target_.resize(table->gains.size());
  std::iota(gains_by_target_.begin(), gains_by_target_.end(), 0U);
  std::sort(gains_by_target_.begin(), gains_by_target_.end(),
            [&gains = table->gains](std::uint32_t a, std::uint32_t b) {
              return std::pair(gains[a].to, gains[a].from) < std::pair(gains[b].to, gains[b].from);
            });
}

void topology::use_overrides() {
  for (const auto& x : config_.links) {
    auto& entry = overrides_.try_emplace({x.from, x.to}, x).first->second;
    if (x.loss)
      entry.loss = x.loss;
    if (x.gain_db)
      entry.gain_db = x.gain_db;
  }
  for (const auto& [link, x] : overrides_)
    if (x.gain_db)
      note_gain(x);
}

void topology::note_gain(const link_override& x) {
  given_gains_[x.from].push_back(x.to);
  given_gains_[x.to].push_back(x.from);
}

void topology::change(const link_override& x) {
  auto& entry = overrides_.try_emplace({x.from, x.to}, link_override{x.from, x.to}).first->second;
  if (x.loss)
    entry.loss = x.loss;
  if (x.gain_db && !entry.gain_db)
    note_gain(x);
  if (x.gain_db)
    entry.gain_db = x.gain_db;
  std::vector<std::uint32_t> senders;
  std::vector<std::uint32_t> receivers;
  radios_of_mote_.clear();
  for (std::uint32_t i = 0; i < sites_.size(); ++i) {
    if (!given_gains_.empty())
      radios_of_mote_[sites_[i].mote].push_back(i);
    if (sites_[i].mote == x.from)
      senders.push_back(i);
    if (sites_[i].mote == x.to)
      receivers.push_back(i);
  }
  for (const auto from : senders)
    for (const auto to : receivers)
      put(from, to, link_between(from, to, path_db(sites_[from], sites_[to])));
}

radio_index topology::add(const site& x) {
  const auto radio = static_cast<std::uint32_t>(sites_.size());
  sites_.push_back(x);
  noise_.push_back(noise_at(x));
  around_.push_back(std::make_shared<hearers>());
  if (const auto node = node_of(x))
    radios_of_node_[*node].push_back(radio);
  if (!given_gains_.empty())
    radios_of_mote_[x.mote].push_back(radio);
  if (!std::holds_alternative<gain_matrix>(config_.propagation)) {
    widen(x.transmit_dbm);
    grid_.insert(radio, x.place);
  }
  renew(radio, met(radio), true);
  return radio_index{radio};
}

void topology::move(radio_index radio, position place) {
  auto& here = sites_[radio.value].place;
  if (std::holds_alternative<gain_matrix>(config_.propagation)) {
    here = place;
    return;
  }
  auto others = met(radio.value);
  grid_.erase(radio.value, here);
  here = place;
  grid_.insert(radio.value, here);
  const auto now = met(radio.value);
  others.insert(others.end(), now.begin(), now.end());
  sort_out(others);
  renew(radio.value, others, false);
}

void topology::shrink() {
  for (auto& list : around_)
    if (list.use_count() == 1)
      list->shrink_to_fit();
}

void topology::set_loss(radio_index from, radio_index to, double loss) {
  losses_[{from, to}] = in_65535ths(loss);
  auto& list = editable(from.value);
  const auto entry = lower_bound(list, to);
  if (entry != list.end() && entry->radio == to)
    entry->loss = in_65535ths(loss);
}

/// Makes the grid's cells as large as a radio of this power needs.
void topology::widen(double transmit_dbm) {
  const auto reach_m = reach_of(config_.propagation, transmit_dbm, config_.cutoff_dbm);
  reach_m_ = std::max(reach_m_, reach_m);
  if (reach_m_ <= grid_.edge_m())
    return;
  grid_ = grid(std::max(reach_m_, 1.25 * grid_.edge_m())); // seldom, however powers grow
  for (std::uint32_t i = 0; i + 1 < sites_.size(); ++i)
    grid_.insert(i, sites_[i].place);
}

/// All that may receive this radio, or that it may receive; some more than once.
std::vector<std::uint32_t> topology::met(std::uint32_t radio) const {
  std::vector<std::uint32_t> all;
  if (std::holds_alternative<gain_matrix>(config_.propagation))
    meet_by_table(radio, all);
  else
    grid_.collect(sites_[radio].place, all);
  if (const auto given = given_gains_.find(sites_[radio].mote); given != given_gains_.end()) {
    for (const auto& mote : given->second) {
      if (const auto other = radios_of_mote_.find(mote); other != radios_of_mote_.end())
        all.insert(all.end(), other->second.begin(), other->second.end());
    }
  }
  return all;
}

void topology::meet_by_table(std::uint32_t radio, std::vector<std::uint32_t>& all) const {
  const auto node = node_of(sites_[radio]);
  if (!node)
    return;
  const auto meet = [&](std::uint16_t other) {
    if (const auto x = radios_of_node_.find(other); x != radios_of_node_.end())
      all.insert(all.end(), x->second.begin(), x->second.end());
  };
  const auto& gains = std::get<gain_matrix>(config_.propagation).table->gains;
  for (auto x =
           std::lower_bound(gains.begin(), gains.end(), std::pair(*node, std::uint16_t{0}), before);
       x != gains.end() && x->from == *node; ++x)
    meet(x->to);
  const auto first =
      std::lower_bound(gains_by_target_.begin(), gains_by_target_.end(), *node,
                       [&](std::uint32_t i, std::uint16_t to) { return gains[i].to < to; });
  for (auto i = first; i != gains_by_target_.end() && gains[*i].to == *node; ++i)
    meet(gains[*i].from);
}

/// @param others all whose links with `radio` exist or may exist now
/// @param is_new no list has it yet
void topology::renew(std::uint32_t radio, const std::vector<std::uint32_t>& others, bool is_new) {
  auto own = std::make_shared<hearers>();
  for (const auto other : others) {
    if (other == radio)
      continue;
    const auto path = path_db(sites_[radio], sites_[other]);
    if (const auto link = link_between(radio, other, path))
      own->push_back(*link);
    if (const auto link = link_between(other, radio, path); link || !is_new)
      put(other, radio, link);
  }
  sort_out(*own);
  around_[radio] = std::move(own);
}

/// The gain that both directions share; nothing beyond anybody's reach, and for a gain_matrix.
std::optional<double> topology::path_db(const site& a, const site& b) const {
  const auto d = distance_m(a.place, b.place);
  if (!(d <= reach_m_))
    return std::nullopt;
  if (std::holds_alternative<unit_disk>(config_.propagation))
    return -loss_db(log_distance{}, d);
  if (const auto* law = std::get_if<log_distance>(&config_.propagation)) {
    const auto mean = -loss_db(*law, d);
    if (law->shadowing_db <= 0)
      return mean;
    return mean + law->shadowing_db * shared_deviate(seed_, a.mote, b.mote);
  }
  if (const auto* law = std::get_if<friis>(&config_.propagation))
    return d > 0 ? std::min(0.0, -(loss_at_1m_db(*law) + 20 * math::log10(d))) : 0.0;
  return std::nullopt;
}

std::optional<double> topology::by_law_dbm(const site& from, const site& to,
                                           std::optional<double> path) const {
  if (const auto* matrix = std::get_if<gain_matrix>(&config_.propagation)) {
    const auto a = node_of(from);
    const auto b = node_of(to);
    if (a && b)
      path = gain_db(*matrix->table, *a, *b);
  }
  if (!path)
    return std::nullopt;
  const auto dbm = from.transmit_dbm + *path;
  const auto* law = std::get_if<log_distance>(&config_.propagation);
  if (!law || law->asymmetry_db <= 0)
    return dbm;
  if (dbm + deviations_max * law->asymmetry_db < config_.cutoff_dbm) // whatever is drawn
    return std::nullopt;
  return dbm + law->asymmetry_db * own_deviate(seed_, from.mote, to.mote);
}

/// @returns nothing out of reach
std::optional<double> topology::arriving_dbm(const site& from, const site& to,
                                             std::optional<double> path) const {
  std::optional<double> dbm;
  bool cut = !std::holds_alternative<unit_disk>(config_.propagation);
  const auto given = overrides_.find({from.mote, to.mote});
  if (given != overrides_.end() && given->second.gain_db) {
    dbm = from.transmit_dbm + *given->second.gain_db;
    cut = true;
  } else {
    dbm = by_law_dbm(from, to, path);
  }
  if (dbm && cut && *dbm < config_.cutoff_dbm)
    return std::nullopt;
  return dbm;
}

std::optional<hearer> topology::link_between(std::uint32_t from, std::uint32_t to,
                                             std::optional<double> path) const {
  if (!share_channel(sites_[from], sites_[to]))
    return std::nullopt;
  const auto dbm = arriving_dbm(sites_[from], sites_[to], path);
  if (!dbm)
    return std::nullopt;
  const auto power = static_cast<float>(to_units(std::min(*dbm, 0.0)));
  hearer x{radio_index{to}, power, 0, loss_between(from, to), 0, 0};
  if (const auto noise = std::max(noise_[to], sites_[to].own_noise); noise != 0)
    x.clean_damage = static_cast<float>(errors_.damage(double{power} / static_cast<double>(noise)));
  const auto rssi = static_cast<int>(std::floor(std::clamp(*dbm + rssi_tolerance_db, -100.0, 0.0)));
  x.rssi_dbm = static_cast<std::int8_t>(rssi);
  x.lqi = static_cast<std::uint8_t>(std::clamp(110 + 3 * (rssi + 75), 50, 110));
  return x;
}

std::uint16_t topology::loss_between(std::uint32_t from, std::uint32_t to) const {
  if (const auto said = losses_.find({radio_index{from}, radio_index{to}}); said != losses_.end())
    return said->second;
  const auto given = overrides_.find({sites_[from].mote, sites_[to].mote});
  const auto has = given != overrides_.end() && given->second.loss;
  return in_65535ths(has ? *given->second.loss : config_.loss);
}

power_units topology::noise_at(const site& x) const {
  if (const auto* constant = std::get_if<constant_noise>(&config_.noise))
    return to_units(std::min(constant->floor_dbm, 30.0));
  const auto node = node_of(x);
  if (!std::holds_alternative<table_noise>(config_.noise) || !node)
    return 0;
  const auto& floors = std::get<gain_matrix>(config_.propagation).table->floors;
  const auto floor =
      std::lower_bound(floors.begin(), floors.end(), *node,
                       [](const gain_table::floor& a, std::uint16_t b) { return a.node < b; });
  if (floor == floors.end() || floor->node != *node)
    return 0;
  return to_units(std::min(double{floor->dbm}, 30.0));
}

/// @returns nothing without a gain_matrix, and below its first mote
std::optional<std::uint16_t> topology::node_of(const site& x) const {
  const auto* matrix = std::get_if<gain_matrix>(&config_.propagation);
  if (!matrix || x.mote.mote.value < matrix->first_mote)
    return std::nullopt;
  return static_cast<std::uint16_t>(x.mote.mote.value - matrix->first_mote);
}

void topology::put(std::uint32_t from, std::uint32_t to, const std::optional<hearer>& link) {
  const radio_index radio{to};
  auto& list = *around_[from];
  const auto at = lower_bound(list, radio) - list.begin();
  const auto old = list.begin() + at;
  const bool there = old != list.end() && old->radio == radio;
  if (there ? link && *old == *link : !link)
    return;
  auto& edited = editable(from);
  const auto entry = edited.begin() + at;
  if (!there)
    edited.insert(entry, *link);
  else if (link)
    *entry = *link;
  else
    edited.erase(entry);
}

hearers& topology::editable(std::uint32_t radio) {
  auto& list = around_[radio];
  if (list.use_count() > 1) // a frame on the air keeps the list it started with
    list = std::make_shared<hearers>(*list);
  return *list;
}

} // namespace rubicon::radio
