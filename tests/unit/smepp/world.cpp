#include "unit/smepp/world.hpp"

#include <algorithm>
#include <numeric>

namespace rubicon::smepp::test {

world::world(world_config config, const change& adapt) : config_(config), rng_(config.seed) {
  nodes_.resize(config.peers);
  for (std::size_t i = 0; i < config.peers; ++i) {
    auto& x = nodes_[i];
    x.config.self = mote_id{static_cast<std::uint16_t>(i + 1)};
    x.config.transducers = 1U << i % 16;
    if (adapt)
      adapt(x.config);
    x.rate = 1 + (2 * rng_.unit() - 1) * config.crystals_ppm * 1e-6;
    x.offset = config.crystals_ppm > 0 ? rng_.between(0s, 10s) : duration{};
    power_on(i + 1);
  }
}

void world::power_on(std::size_t i) {
  auto& x = nodes_[i - 1];
  x.is_off = false;
  if (x.is_on)
    x.on_for += now_ - x.on_since;
  x.is_on = false;
  x.core = std::make_unique<peer>(x.config, random_stream(rng_.next()), local(x, now_), x.store);
  with(i, [&](peer& each, instant t, outputs& out) {
    each.smepp_newPeer(network.confidentiality, network.integrity, t, out);
  });
}

bool world::reaches(std::size_t a, std::size_t b) const {
  if (is_cut_ && is_cut_(a + 1, b + 1))
    return false;
  const auto columns = config_.columns;
  const auto apart = [](std::size_t x, std::size_t y) { return x > y ? x - y : y - x; };
  return apart(a / columns, b / columns) + apart(a % columns, b % columns) == 1;
}

void world::perform(std::size_t i, outputs& out) {
  auto& x = nodes_[i];
  for (auto& each : out) {
    if (auto* const frame = std::get_if<send_frame>(&each)) {
      transmit(i, std::move(*frame), config_.link_tries);
    } else if (auto* const store = std::get_if<store_state>(&each)) {
      x.store = std::move(store->content);
    } else if (const auto* const radio = std::get_if<set_radio>(&each)) {
      if (radio->on)
        x.on_since = now_;
      else
        x.on_for += now_ - x.on_since;
      x.is_on = radio->on;
    } else {
      x.signals.emplace_back(now_, std::get<signal>(each));
    }
  }
  const auto due = x.core->deadline();
  x.due = due ? std::optional(std::max(now_, true_time(x, *due))) : std::nullopt;
}

void world::transmit(std::size_t i, send_frame x, unsigned tries) {
  constexpr duration octet_time = 32us;
  constexpr std::size_t radio_overhead = 6 + 11;
  const auto access = rng_.between(1ms, 5ms);
  const auto frame_time = octet_time * static_cast<std::int64_t>(x.octets.size() + radio_overhead);
  const auto* const life = nodes_[i].core.get();
  later(access, [this, i, x = std::move(x), tries, frame_time, life] {
    if (nodes_[i].is_off || nodes_[i].core.get() != life)
      return;
    ++frames_;
    octets_ += x.octets.size();
    const auto from = nodes_[i].config.self;
    if (records_air_)
      air_.push_back({from, x.to, x.octets, std::string(x.what), now_});
    bool acked = x.to == broadcast_mote;
    for (std::size_t j = 0; j < nodes_.size(); ++j) {
      auto& other = nodes_[j];
      const bool is_for = x.to == broadcast_mote || x.to == other.config.self;
      if (!is_for || !reaches(i, j) || other.is_off || !other.is_on || rng_.chance(config_.loss))
        continue;
      if (x.to == other.config.self)
        acked = !rng_.chance(config_.loss);
      outputs out;
      const auto at = local(other, now_);
      other.core->on_frame(from, x.to, x.octets, at - time_stamp_error(), at, out);
      perform(j, out);
    }
    if (!acked && tries > 1)
      return transmit(i, x, tries - 1);
    const auto at = local(nodes_[i], now_) - time_stamp_error();
    later(frame_time, [this, i, id = x.id, acked, at, life] {
      if (nodes_[i].is_off || nodes_[i].core.get() != life)
        return;
      outputs out;
      nodes_[i].core->on_sent(id, acked, at, local(nodes_[i], now_), out);
      perform(i, out);
    });
  });
}

void world::inject(std::size_t to, mote_id from, mote_id receiver, const bytes& octets) {
  auto& x = nodes_[to - 1];
  outputs out;
  x.core->on_frame(from, receiver, octets, local(x, now_), local(x, now_), out);
  perform(to - 1, out);
}

void world::run_for(duration x) {
  const auto end = now_ + x;
  for (;;) {
    std::size_t next = nodes_.size();
    auto at = events_.empty() ? end : std::min(end, events_.top().at);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (!nodes_[i].is_off && nodes_[i].due && *nodes_[i].due < at) {
        at = *nodes_[i].due;
        next = i;
      }
    now_ = std::max(now_, at);
    if (next < nodes_.size()) {
      outputs out;
      nodes_[next].core->on_time(local(nodes_[next], now_), out);
      perform(next, out);
    } else if (!events_.empty() && events_.top().at <= end) {
      const auto what = events_.top().what;
      events_.pop();
      what();
    } else {
      return;
    }
  }
}

bool world::run_until(const std::function<bool()>& done, duration limit, duration step) {
  for (const auto end = now_ + limit; now_ < end; run_for(step))
    if (done())
      return true;
  return done();
}

duration world::radio_time(std::size_t i) const {
  const auto& x = nodes_[i - 1];
  return x.on_for + (x.is_on ? now_ - x.on_since : duration{});
}

std::vector<group_id> world::find_groups(std::size_t i, const group_filter& filter) {
  auto& x = nodes_[i - 1];
  x.signals.clear();
  with(i, [&](peer& each, instant t, outputs& out) { each.smepp_getGroups(filter, t, out); });
  run_until([&] { return !signals<getGroups_result>(i).empty(); }, 10s);
  return signals<getGroups_result>(i).at(0).groups;
}

std::optional<failure> world::subscribe(std::size_t i, group_id group, const std::string& name,
                                        double rate, std::optional<duration> expiration,
                                        bool receives) {
  return with(i, [&](peer& each, instant t, outputs& out) {
    auto error = each.smepp_subscribe(name, group, expiration, rate, t, out);
    if (!error && receives)
      error = each.smepp_receive(group, name, 0, t, out);
    return error;
  });
}

std::optional<failure> world::raise(std::size_t i, group_id group, const std::string& name,
                                    const bytes& value) {
  return with(i, [&](peer& each, instant t, outputs& out) {
    return each.smepp_event(group, name, value, t, out);
  });
}

std::optional<failure> world::leave(std::size_t i, group_id group) {
  return with(
      i, [&](peer& each, instant t, outputs& out) { return each.smepp_leaveGroup(group, t, out); });
}

std::optional<failure> world::join(std::size_t i, group_id group, const std::optional<key>& master,
                                   const group_filter& filter) {
  static_cast<void>(find_groups(i, filter));
  with(i,
       [&](peer& each, instant t, outputs& out) { each.smepp_joinGroup(group, master, t, out); });
  run_until([&] { return !signals<joinGroup_result>(i).empty(); }, 120s);
  const auto results = signals<joinGroup_result>(i);
  return results.empty() ? std::optional(failure::no_answer) : results.front().error;
}

group_id world::build_group(const group_description& x) {
  const auto created = with(
      1, [&](peer& each, instant t, outputs& out) { return each.smepp_createGroup(x, t, out); });
  const auto group = std::get<group_id>(created);
  for (std::size_t i = 2; i <= size(); ++i)
    for (int tries = 0; tries < 3; ++tries)
      if (!join(i, group, x.master, {.master = x.master}))
        break;
  std::vector<std::size_t> all(size());
  std::iota(all.begin(), all.end(), std::size_t{1});
  run_until([&] { return agree(group, all); }, 5min);
  return group;
}

bool world::agree(group_id group, const std::vector<std::size_t>& who) const {
  const auto* const first = nodes_[who.front() - 1].core->groups().find(group);
  return first != nullptr && std::ranges::all_of(who, [&](std::size_t i) {
           const auto* const g = nodes_[i - 1].core->groups().find(group);
           return g != nullptr && g->ring.best().id == first->ring.best().id &&
                  g->members.digest() == first->members.digest() && !g->is_returning;
         });
}

} // namespace rubicon::smepp::test
