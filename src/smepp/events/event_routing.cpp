// How events go up the trees of their subscriptions.
#include <algorithm>
#include <cassert>

#include "core/hash.hpp"
#include "smepp/events/event_management.hpp"

namespace rubicon::smepp {

namespace {

std::uint16_t content_of(const event& x) {
  fold64 fold;
  if (x.proof)
    fold.add(x.proof->number).add(byte_view(x.proof->mac));
  fold.add(byte_view(x.value));
  return static_cast<std::uint16_t>(fold.value());
}

} // namespace

bool event_management::is_new(group_id group, const smepp::event& event) {
  const mark x{group, event.id, event.producer, event.sequence, content_of(event)};
  if (std::ranges::find(seen_, x) != seen_.end())
    return false;
  if (seen_.size() >= config_.seen_max)
    seen_.erase(seen_.begin());
  seen_.push_back(x);
  return true;
}

void event_management::on_message(mote_id from, const smepp::event& x, const group& g, context c) {
  const auto* const known = find(g.id, x.id);
  if (known == nullptr)
    return drop("no_subscription");
  if (known->depth == 0)
    return take(x, *known, false, c);
  if (!is_new(g.id, x)) {
    ++counters_.duplicates;
    return;
  }
  if (x.hops + 1 >= config_.hops_max)
    return drop("too_far");
  if (known->parent == from && known->other_parent == no_mote)
    return drop("loop"); // our parent believes that we are nearer; the next round knows
  auto onward = x;
  ++onward.hops;
  ++counters_.forwarded;
  enqueue(g.id, std::move(onward), c);
  pump(c);
}

/// At its subscriber. What is not proven is no reason to take something else for a repetition.
/// @param is_own raised here; what comes from elsewhere in our name is not
void event_management::take(const smepp::event& x, const subscription& to, bool is_own, context c) {
  const bool has_proof = !is_own && pairwise_.is_proven(x, to.group, to.made_at);
  const bool is_proven = is_own || has_proof;
  if (config_.authenticates_sender && !is_proven)
    return drop("sender_unproven");
  if (!is_own && !(has_proof ? pairwise_.take(x) : is_new(to.group, x))) {
    ++counters_.duplicates;
    return;
  }
  if (!to.is_received)
    return drop("not_waited_for");
  ++counters_.received;
  c.out.push_back(signal{receive_result{x.producer, to.group, to.name, x.value, is_proven}});
}

void event_management::enqueue(group_id group, smepp::event x, context c) {
  if (queue_.size() >= config_.events_max)
    return drop("queue_full");
  queue_.push_back({group, std::move(x), 0, c.now});
}

/// Hands out all hops that are due. An event whose parent does not acknowledge goes to the other
/// one by turns.
void event_management::pump(context c) {
  forget([&](const waiting& x) { return x.token == 0 && find(x.group, x.what.id) == nullptr; });
  for (auto& x : queue_) {
    if (x.token != 0 || x.due > c.now)
      continue;
    const auto* const tree = find(x.group, x.what.id);
    const bool takes_other = x.tries % 2 == 1 && tree->other_parent != no_mote;
    x.token = ++token_;
    to_send hop{takes_other ? tree->other_parent : tree->parent, x.group, x.what,
                slot::subscription};
    hop.subscription = x.what.id;
    hop.token = x.token;
    hop.from = x.from;
    c.out.push_back(hop);
  }
}

void event_management::on_sent(std::uint64_t token, bool acked, context c) {
  const auto found = std::ranges::find(queue_, token, &waiting::token);
  if (found == queue_.end())
    return;
  ++found->tries;
  if (acked || found->tries >= config_.hop_tries) {
    if (!acked)
      drop("gave_up");
    queue_.erase(found);
    return;
  }
  ++counters_.repeated;
  found->token = 0;
  found->due =
      c.now + config_.hop_pause * found->tries + rng_.between(duration{}, config_.hop_pause);
}

} // namespace rubicon::smepp
