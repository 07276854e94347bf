#include "network/channels/channel_table.hpp"

#include <chrono>
#include <utility>

namespace rubicon::network {

const channel_entry* channel_table::find(channel_id channel) const {
  const auto found = entries_.find(channel);
  return found != entries_.end() ? &found->second : nullptr;
}

channel_entry* channel_table::find(channel_id channel) {
  const auto found = entries_.find(channel);
  return found != entries_.end() ? &found->second : nullptr;
}

channel_entry* channel_table::find_by(channel_id channel, mote_id neighbour) {
  auto* const x = find(channel);
  return x != nullptr && (x->previous == neighbour || x->next == neighbour) ? x : nullptr;
}

void channel_table::free(channel_id id, channel_end why, std::optional<mote_id> informed_by,
                         channels_outputs& out, instant now) {
  const auto gone = entries_.extract(id);
  if (gone.empty())
    return;
  const auto& x = gone.mapped();
  queue_.drop(id);
  for (const auto& side : {x.previous, x.next}) {
    if (side && side != informed_by)
      queue(*side, {id, end_message{why}}, now);
  }
  out.emplace_back(channel_reserved{id, {}});
  const bool is_end = !x.previous || x.request.destination == config_.self;
  if (is_end && informed_by != config_.self)
    out.emplace_back(channel_ended{id, why});
}

void channel_table::reserve(channel_id id, const channel_entry& x, channels_outputs& out) {
  auto schedule = x.request.schedule;
  schedule.first += std::chrono::microseconds(x.request.delay_us);
  out.emplace_back(channel_reserved{id, schedule, x.previous});
}

void channel_table::queue(mote_id next, channel_message message, instant due, departure how) {
  switch (queue_.add(next, std::move(message), due, how)) {
  case hop_queue::outcome::lost:
    ++counters_.packets_lost;
    break;
  case hop_queue::outcome::crowded_out:
    ++counters_.crowded_out;
    break;
  case hop_queue::outcome::queued:
  case hop_queue::outcome::repeated:
    break;
  }
}

void channel_table::pump(channels_outputs& out, instant now) {
  if (auto next = queue_.take(now))
    out.emplace_back(*std::move(next));
}

} // namespace rubicon::network
