// Messages of topics that wait to be sent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "core/time.hpp"

namespace rubicon::bridge {

/// Each topic has a queue of its own, which drops its oldest message when it is full, and a least
/// time between two messages. Topics take turns.
class topic_outbox {
public:
  struct limits {
    duration every{}; ///< least time between two messages
    std::size_t waiting_max = 1;
  };

  /// @returns the number of the topic: 0 for the first one
  std::size_t add_topic(limits x);

  void add(std::size_t topic, std::string message, instant now);
  void clear(); ///< drops all messages; topics remain

  /// At most so many of those that are due.
  [[nodiscard]] std::vector<std::string> take(std::size_t most, instant now);
  /// When take() returns the next one; nothing while none waits.
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t longest() const { return longest_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

private:
  struct line {
    limits limit;
    std::deque<std::string> waiting;
    instant free_at{}; ///< when the next message may leave
  };

  /// A topic with a message, in the order of turns.
  using turn = std::tuple<instant, std::uint64_t, std::size_t>;

  std::vector<line> lines_;
  std::set<turn> turns_;
  std::uint64_t turn_ = 0;
  std::size_t size_ = 0;
  std::size_t longest_ = 0;
  std::uint64_t dropped_ = 0;
};

} // namespace rubicon::bridge
