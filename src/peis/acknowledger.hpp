// Collects what is to be acknowledged, so that a burst costs few packages (ACK-06).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::peis {

/// Ids per source, due together: the first one collected starts the delay of all.
class acknowledger {
public:
  static constexpr std::size_t batch = 100; ///< as many are sent at once (part C)

  explicit acknowledger(duration delay = 10ms) : delay_(delay) {}

  /// @returns the batch for `source` if this id has filled it
  [[nodiscard]] std::vector<std::int32_t> add(peer_id source, std::int32_t ack_id, instant now) {
    auto& ids = ids_[source];
    ids.push_back(ack_id);
    if (!due_)
      due_ = now + delay_;
    if (ids.size() < batch)
      return {};
    auto full = std::move(ids);
    ids_.erase(source);
    if (ids_.empty())
      due_.reset();
    return full;
  }

  /// All that is collected, if it is due.
  [[nodiscard]] std::map<peer_id, std::vector<std::int32_t>> take(instant now) {
    if (!due_ || now < *due_)
      return {};
    due_.reset();
    return std::exchange(ids_, {});
  }

  void drop(peer_id source) { ids_.erase(source); }

  [[nodiscard]] std::optional<instant> deadline() const { return due_; }

private:
  std::map<peer_id, std::vector<std::int32_t>> ids_;
  std::optional<instant> due_;
  duration delay_;
};

} // namespace rubicon::peis
