#include "gateway/island_motes.hpp"

#include <utility>

#include "core/hash.hpp"
#include "gateway/tuples.hpp"

namespace rubicon::gateway {

std::optional<island_motes::join> island_motes::on_joined(const network::mote_joined& x,
                                                          const occasion& at) {
  if (listed_.size() >= config_.motes_max && !listed_.contains(x.mote)) {
    ++at.counters.devices_refused;
    return std::nullopt;
  }
  const auto [listed, is_new] = listed_.try_emplace(x.mote);
  auto& entry = listed->second;
  const auto described = fold64().add(x.type).add(byte_view(x.descriptor)).value();
  join how{is_new, entry.incarnation != x.incarnation, false};
  // A mote is the same all its life: one of two that differ is wrong. The sink knows.
  how.contradicts = !is_new && !how.restarted && entry.described != described;
  entry.incarnation = x.incarnation;
  entry.described = described;
  entry.stale = false;
  entry.plain = at.of_plain;
  at.out.emplace_back(publish{device_type_key(x.mote), device_type_octets(x.type), false});
  at.out.emplace_back(publish{device_descriptor_key(x.mote), x.descriptor, false});
  at.out.emplace_back(list_tuple());
  at.out.emplace_back(presence_tuple(x.mote, {device_presence::listed, {}, at.now}));
  if (is_new || how.restarted)
    at.out.emplace_back(member_changed{x.mote, true, x.incarnation, {}});
  return how;
}

bool island_motes::on_left(const network::mote_left& x, const occasion& at) {
  const auto found = listed_.extract(x.mote);
  if (found.empty())
    return false;
  const auto& entry = found.mapped();
  at.out.emplace_back(
      presence_tuple(x.mote, {device_presence::left, network::to_string(x.cause), at.now}));
  at.out.emplace_back(list_tuple());
  at.out.emplace_back(erase{device_type_key(x.mote)});
  at.out.emplace_back(erase{device_descriptor_key(x.mote)});
  for (const auto channel : entry.output_channels)
    at.out.emplace_back(erase{device_output_key(x.mote, channel)});
  for (const auto channel : entry.input_channels)
    at.out.emplace_back(erase{device_input_status_key(x.mote, channel)});
  at.out.emplace_back(member_changed{x.mote, false, entry.incarnation, x.cause});
  return true;
}

void island_motes::on_roster(const network::roster& x, const occasion& at) {
  if (roster_number_ != x.number) {
    roster_number_ = x.number;
    roster_motes_.clear();
    roster_pages_ = 0;
  }
  ++roster_pages_;
  for (const auto& [mote, incarnation] : x.entries) {
    roster_motes_.insert(mote);
    const auto known = listed_.find(mote);
    if (known == listed_.end() || known->second.incarnation != incarnation)
      at.out.emplace_back(ask_about(mote));
    else
      refresh(mote, at);
  }
  if (roster_pages_ >= x.pages)
    end_roster(at);
}

void island_motes::end_roster(const occasion& at) {
  for (const auto& [mote, listed] : listed_) {
    const bool may_rejoin = listed.stale && at.now < rejoin_until_;
    if (!roster_motes_.contains(mote) && !may_rejoin && !listed.plain)
      at.out.emplace_back(ask_about(mote));
  }
  roster_number_.reset();
}

void island_motes::on_sink_started(const occasion& at) {
  rejoin_until_ = at.now + config_.rejoin_wait;
  make_stale(at);
}

void island_motes::refresh(mote_id mote, const occasion& at) {
  const auto listed = listed_.find(mote);
  if (listed != listed_.end() && std::exchange(listed->second.stale, false))
    at.out.emplace_back(presence_tuple(mote, {device_presence::listed, {}, at.now}));
}

void island_motes::make_stale(const occasion& at) {
  for (auto& [mote, x] : listed_)
    if (!x.plain || !config_.has_real_line)
      make_stale(x, mote, at);
}

void island_motes::make_plain_stale(const occasion& at) {
  for (auto& [mote, x] : listed_)
    if (x.plain)
      make_stale(x, mote, at);
}

void island_motes::make_stale(listed_mote& x, mote_id id, const occasion& at) {
  if (!std::exchange(x.stale, true))
    at.out.emplace_back(presence_tuple(id, {device_presence::stale, {}, at.now}));
}

void island_motes::note_output(mote_id mote, std::uint16_t channel) {
  listed_.at(mote).output_channels.insert(channel);
}

void island_motes::note_input(mote_id mote, std::uint16_t channel) {
  listed_.at(mote).input_channels.insert(channel);
}

void island_motes::erase_outputs(const occasion& at) {
  for (auto& [mote, x] : listed_)
    for (const auto channel : std::exchange(x.output_channels, {}))
      at.out.emplace_back(erase{device_output_key(mote, channel)});
}

bool island_motes::is_plain(mote_id x) const {
  const auto listed = listed_.find(x);
  return listed != listed_.end() && listed->second.plain;
}

std::vector<mote_id> island_motes::all() const {
  std::vector<mote_id> ids;
  for (const auto& [mote, entry] : listed_)
    ids.push_back(mote);
  return ids;
}

publish island_motes::list_tuple() const {
  return text_tuple(std::string(devices_key), device_list_text(all()));
}

} // namespace rubicon::gateway
