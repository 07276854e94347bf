#include "hostile/driver/player.hpp"

#include <algorithm>

#include <poll.h>

namespace rubicon::hostile {

namespace {

constexpr std::size_t waiting_max = 256 * 1024; ///< octets of one link, before we wait for it
constexpr int calls_a_turn = 16; ///< of say(), a link, before sockets are asked again

} // namespace

player::player(const attack_kind& kind, const play_config& config)
    : config_(config), rate_(config.rate < 0 ? kind.rate : config.rate),
      attack_(kind.make(config.whom)) {
  const random_stream rng(config.seed, kind.name);
  for (std::size_t i = 0; i < config.links; ++i) {
    const random_stream own(config.seed, std::string(kind.name) + '/' + std::to_string(i));
    seats_.push_back({std::make_unique<link>(config.whom, i, own), {}});
  }
}

play_result player::play() {
  start_ = steady::now();
  while (steady::now() - start_ < config_.length) {
    open_closed();
    poll_links();
    talk();
  }
  play_result x;
  x.took = steady::now() - start_;
  for (auto& each : seats_) {
    each.its->drop(false);
    const auto& counts = each.its->counts();
    x.counts.packages += counts.packages;
    x.counts.octets += counts.octets;
    x.counts.heard += counts.heard;
    x.counts.opened += counts.opened;
    x.counts.cut += counts.cut;
  }
  return x;
}

void player::open_closed() {
  const auto now = steady::now();
  for (auto& each : seats_) {
    if (!each.its->closed() || each.reopen > now)
      continue;
    each.its->connect(attack_->receive_buffer());
    each.reopen = now + attack_->reopened_after();
  }
}

void player::poll_links() {
  std::vector<pollfd> all;
  std::vector<link*> polled;
  for (auto& each : seats_) {
    if (each.its->closed())
      continue;
    all.push_back({each.its->descriptor(), each.its->events(attack_->reads(*each.its)), 0});
    polled.push_back(each.its.get());
  }
  ::poll(all.data(), all.size(), eager_ ? 0 : 1);
  for (std::size_t i = 0; i < all.size(); ++i) {
    auto& x = *polled[i];
    if (all[i].revents == 0)
      continue;
    const bool was_open = x.open();
    x.on_events(all[i].revents, attack_->reads(x),
                [&](const peis::received_package& heard) { attack_->hear(x, heard); });
    if (!was_open && x.open())
      attack_->open(x);
  }
}

double player::allowed() const {
  constexpr double burst_s = 0.1; // what could not be said in time is not made up for
  return rate_ == 0
             ? 1e9
             : std::min(seconds(steady::now() - start_) * rate_ - said_, rate_ * burst_s + 1);
}

void player::talk() {
  auto left = allowed();
  if (rate_ > 0)
    said_ = std::max(said_, seconds(steady::now() - start_) * rate_ - left);
  eager_ = false;
  for (std::size_t i = 0; i < seats_.size() && left >= 1; ++i) {
    auto& x = *seats_[(next_ + i) % seats_.size()].its;
    for (int calls = 0; calls < calls_a_turn && left >= 1 && talk(x); ++calls) {
      said_ += 1;
      left -= 1;
      eager_ = true;
    }
  }
  next_ = (next_ + 1) % seats_.size();
}

/// @returns whether something was said
bool player::talk(link& x) {
  if (!x.open() || x.waiting() > waiting_max)
    return false;
  if (x.has_fragments())
    x.say_fragment();
  else
    attack_->say(x);
  return true;
}

} // namespace rubicon::hostile
