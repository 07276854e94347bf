// Collects what is to be acknowledged, so that a burst costs few packages (ACK-06).
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::peis {

/// Ids per source. The first after a pause is due at once, those that follow at the end of the
/// delay, all together: a single message waits for nothing, a burst costs few packages. Each id is
/// sent twice, with its own batch and with the next: a lost acknowledgement rarely costs a repeat.
/// A source of which nothing has come for a while is forgotten; while there are too many, what a
/// further one sends is acknowledged one by one.
class acknowledger {
public:
  static constexpr std::size_t batch = 100; ///< as many are sent at once (part C)
  static constexpr std::size_t sources_max = 4096;
  static constexpr duration memory = 2s; ///< of a source without news

  explicit acknowledger(duration delay = 10ms) : delay_(delay) {}

  /// @returns the batch for `source` if this id has filled it
  [[nodiscard]] std::vector<std::int32_t> add(peer_id source, std::int32_t ack_id, instant now) {
    if (sources_.size() >= sources_max && !sources_.contains(source))
      return {ack_id};
    auto& x = sources_[source];
    if (x.ids.empty())
      waiting_.push_back(source);
    x.ids.push_back(ack_id);
    due_ = earliest(due_, std::max(now, x.next));
    if (x.ids.size() < batch)
      return {};
    std::erase(waiting_, source);
    return finish(x, now);
  }

  /// All that is due, ascending by source.
  [[nodiscard]] std::vector<std::pair<peer_id, std::vector<std::int32_t>>> take(instant now) {
    std::vector<std::pair<peer_id, std::vector<std::int32_t>>> all;
    if (!due_ || now < *due_)
      return all;
    due_.reset();
    std::sort(waiting_.begin(), waiting_.end());
    std::erase_if(waiting_, [&](peer_id source) {
      auto& x = sources_.at(source);
      if (x.next > now) {
        due_ = earliest(due_, x.next);
        return false;
      }
      all.emplace_back(source, finish(x, now));
      return true;
    });
    forget_idle(now);
    return all;
  }

  void drop(peer_id source) {
    sources_.erase(source);
    std::erase(waiting_, source);
  }

  [[nodiscard]] std::optional<instant> deadline() const { return due_; }
  [[nodiscard]] std::size_t sources() const { return sources_.size(); }

private:
  struct collection {
    std::vector<std::int32_t> ids;
    std::vector<std::int32_t> previous;
    instant next = instant::min(); ///< earliest time of the next package
  };

  [[nodiscard]] std::vector<std::int32_t> finish(collection& x, instant now) const {
    x.next = now + delay_;
    auto all = x.ids;
    all.insert(all.end(), x.previous.begin(), x.previous.end());
    x.previous = std::exchange(x.ids, {});
    return all;
  }

  void forget_idle(instant now) {
    if (now < next_review_)
      return;
    next_review_ = now + memory;
    std::erase_if(sources_, [&](const auto& x) {
      return x.second.ids.empty() && x.second.next + memory <= now;
    });
  }

  std::map<peer_id, collection> sources_;
  std::vector<peer_id> waiting_; ///< those with ids
  std::optional<instant> due_;
  instant next_review_;
  duration delay_;
};

} // namespace rubicon::peis
