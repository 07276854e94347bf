#include "rfid/reader.hpp"

#include <algorithm>
#include <cmath>

#include "core/numbers/math.hpp"
#include "core/tuples/interface_keys.hpp"

namespace rubicon::rfid {

namespace {

constexpr double nearest_m = 0.05; ///< a tag cannot be nearer to the antenna

publish text_tuple(interface_key key, std::string_view text) {
  return {to_string(key), to_bytes(text), true};
}

std::string rssi_text(double dbm) {
  return std::to_string(std::lround(dbm));
}

} // namespace

reader::reader(reader_config config, std::shared_ptr<const tags> world, random_stream rng)
    : config_(std::move(config)), world_(std::move(world)), rng_(rng) {}

outputs reader::start(instant now) {
  due_ = now + rng_.between(0s, config_.period); // readers do not go in step
  return {text_tuple({interface_tuple::channel, config_.name, {}}, "rfid"),
          text_tuple({interface_tuple::position, config_.name, {}}, position_text(config_.place)),
          list()};
}

outputs reader::on_time(instant now) {
  outputs out;
  if (!due_ || *due_ > now)
    return out;
  *due_ += config_.period;
  bool changed = false;
  for (const auto& x : *world_) {
    const auto dbm = strength(x, now);
    const auto found = seen_.find(x.id);
    const interface_key rssi{interface_tuple::rssi, config_.name, x.id};
    const interface_key memory{interface_tuple::memory, config_.name, x.id};
    if (!dbm) {
      if (found == seen_.end() || ++found->second.missed < config_.missed_max)
        continue;
      seen_.erase(found);
      out.emplace_back(erase{to_string(rssi)});
      out.emplace_back(erase{to_string(memory)});
      changed = true;
      continue;
    }
    if (found == seen_.end()) {
      seen_[x.id] = {0, *dbm};
      out.emplace_back(text_tuple(rssi, rssi_text(*dbm)));
      out.emplace_back(publish{to_string(memory), x.memory, false});
      changed = true;
      continue;
    }
    found->second.missed = 0;
    if (std::abs(*dbm - found->second.rssi_dbm) >= config_.rssi_step_db) {
      found->second.rssi_dbm = *dbm;
      out.emplace_back(text_tuple(rssi, rssi_text(*dbm)));
    }
  }
  if (changed)
    out.emplace_back(list());
  return out;
}

/// How strongly this inventory perceives a tag; nothing: it does not.
std::optional<double> reader::strength(const tag& x, instant now) {
  const auto there = x.walk.at(now);
  const auto distance_m = math::length(there.x_m - config_.place.x_m, there.y_m - config_.place.y_m,
                                       there.z_m - config_.place.z_m);
  if (distance_m > config_.range_m || rng_.chance(config_.miss_rate))
    return std::nullopt;
  return config_.rssi_1m_dbm - 10 * config_.exponent * math::log10(std::max(distance_m, nearest_m));
}

publish reader::list() const {
  std::vector<std::string> ids;
  for (const auto& [id, x] : seen_)
    ids.push_back(id);
  return text_tuple({interface_tuple::objects, config_.name, {}}, object_list_text(std::move(ids)));
}

} // namespace rubicon::rfid
