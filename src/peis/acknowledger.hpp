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
class acknowledger {
public:
  static constexpr std::size_t batch = 100; ///< as many are sent at once (part C)

  explicit acknowledger(duration delay = 10ms) : delay_(delay) {}

  /// @returns the batch for `source` if this id has filled it
  [[nodiscard]] std::vector<std::int32_t> add(peer_id source, std::int32_t ack_id, instant now) {
    auto& x = sources_[source];
    x.ids.push_back(ack_id);
    due_ = earliest(due_, std::max(now, x.next));
    if (x.ids.size() < batch)
      return {};
    return finish(x, now);
  }

  /// All that is due.
  [[nodiscard]] std::vector<std::pair<peer_id, std::vector<std::int32_t>>> take(instant now) {
    std::vector<std::pair<peer_id, std::vector<std::int32_t>>> all;
    if (!due_ || now < *due_)
      return all;
    due_.reset();
    for (auto& [source, x] : sources_) {
      if (x.ids.empty())
        continue;
      if (x.next > now) {
        due_ = earliest(due_, x.next);
        continue;
      }
      all.emplace_back(source, finish(x, now));
    }
    return all;
  }

  void drop(peer_id source) { sources_.erase(source); }

  [[nodiscard]] std::optional<instant> deadline() const { return due_; }

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

  std::map<peer_id, collection> sources_;
  std::optional<instant> due_;
  duration delay_;
};

} // namespace rubicon::peis
