#include "peis_world.hpp"

#include <algorithm>

namespace rubicon::peis::test {

kernel_config config_of(std::int32_t id) {
  kernel_config config;
  config.network.id = peer_id{id};
  config.network.name = "peer" + std::to_string(id);
  config.network.host_name = "host" + std::to_string(id);
  config.network.network = "test";
  return config;
}

peer_id world::add(std::int32_t id) {
  return add(config_of(id));
}

peer_id world::add(kernel_config config) {
  const auto id = config.network.id;
  auto& x = peers_[id];
  x.config = std::move(config);
  start(x);
  return id;
}

void world::start(peer& x) {
  const auto path = to_string(x.config.network.id) + '/' + std::to_string(x.lives++);
  x.kernel = rubicon::peis::kernel(x.config, random_stream(seed_, path), now_);
}

void world::restart(peer_id id) {
  start(peers_.at(id));
}

link_id world::connect(peer_id a, peer_id b, duration delay) {
  const link_id link{next_link_++};
  auto& x = cables_[link];
  x = {a, b, delay, {}, {}};
  x.from_a.request_due = true;
  perform(b, at(b).on_link_open(link, link_role::acceptor, now_));
  perform(a, at(a).on_link_open(link, link_role::initiator, now_));
  return link;
}

void world::cut(link_id link) {
  const auto x = cables_.at(link);
  cables_.erase(link);
  perform(x.a, at(x.a).on_link_closed(link, now_));
  perform(x.b, at(x.b).on_link_closed(link, now_));
}

void world::perform(peer_id id, outputs todo) {
  auto& x = peers_.at(id);
  for (auto& output : todo) {
    if (const auto* octets = std::get_if<to_link>(&output)) {
      carry(id, *octets);
    } else {
      if (const auto* closed = std::get_if<close_link>(&output)) {
        const auto cable = cables_.find(closed->link);
        if (cable != cables_.end()) {
          const auto other = cable->second.a == id ? cable->second.b : cable->second.a;
          cables_.erase(cable);
          perform(other, at(other).on_link_closed(closed->link, now_));
        }
      }
      x.log.emplace_back(now_, std::move(output));
    }
  }
}

/// Cuts the stream into packages, so that single ones can be lost.
void world::carry(peer_id from, const to_link& x) {
  const auto found = cables_.find(x.link);
  if (found == cables_.end())
    return;
  auto& cable = found->second;
  const bool is_a = cable.a == from;
  auto& way = is_a ? cable.from_a : cable.from_b;
  bytes kept;
  way.decoder.feed(x.octets.view());
  if (way.request_due) {
    if (const auto request = way.decoder.take_connect_request()) {
      kept = to_bytes(*request);
      way.request_due = false;
    }
  }
  while (const auto package = way.decoder.next()) {
    const bool lost = keep && !keep(package->header);
    packages.push_back({now_, from, package->header, lost});
    if (lost)
      continue;
    encode(package->header, kept);
    kept.insert(kept.end(), package->data.begin(), package->data.end());
  }
  const auto to = is_a ? cable.b : cable.a;
  const auto delay = cable.delay;
  under_way_.emplace(now_ + delay, shipment{x.link, to, std::move(kept)});
  if (drains)
    under_way_.emplace(now_ + delay, shipment{x.link, from, {}});
}

void world::deliver(const shipment& x) {
  if (!cables_.contains(x.link))
    return;
  if (x.octets.empty())
    perform(x.to, at(x.to).on_link_sent(x.link, SIZE_MAX, now_));
  else
    perform(x.to, at(x.to).on_link_octets(x.link, x.octets, now_));
}

void world::run_for(duration length) {
  const auto end = now_ + length;
  for (;;) {
    auto next = end;
    peer* due = nullptr;
    peer_id who;
    for (auto& [id, x] : peers_) {
      const auto deadline = x.kernel.deadline();
      if (deadline && *deadline < next) {
        next = std::max(*deadline, now_);
        due = &x;
        who = id;
      }
    }
    if (!under_way_.empty() && under_way_.begin()->first <= next) {
      const auto x = under_way_.extract(under_way_.begin());
      now_ = std::max(now_, x.key());
      if (now_ > end)
        break;
      deliver(x.mapped());
    } else if (due != nullptr) {
      now_ = next;
      ++due->wakeups;
      perform(who, due->kernel.on_time(now_));
    } else {
      break;
    }
  }
  now_ = end;
}

void world::clear_logs() {
  for (auto& [id, x] : peers_)
    x.log.clear();
  packages.clear();
}

} // namespace rubicon::peis::test
