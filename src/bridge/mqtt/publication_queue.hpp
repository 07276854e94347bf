// Publications that wait to be sent: one for each topic, at a limited rate.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace rubicon::bridge {

/// A message for the broker. All are retained.
struct publication {
  std::string topic;
  std::string payload; ///< empty: the broker deletes what it has retained

  friend bool operator==(const publication&, const publication&) = default;
};

/// In order of urgency. What earlier lives have left at the broker comes last: others may have
/// written any amount of it.
enum class urgency : std::uint8_t { announcement, availability, state, leftover };

/// A newer payload for a topic replaces the one that waits, in its place, so the queue is as long
/// as there are topics. In each slot a share of the messages of a second may leave.
class publication_queue {
public:
  static constexpr duration slot = 100ms;

  /// @param rate messages that leave within any second, at least 11
  explicit publication_queue(std::uint32_t rate = 190) : per_slot_(rate / 11) {}

  void add(urgency how, publication x);
  void clear();

  [[nodiscard]] std::vector<publication> take(instant now);
  /// When take() returns the next ones; nothing while none waits.
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] std::size_t size() const { return payloads_.size(); }
  [[nodiscard]] std::uint64_t replaced() const { return replaced_; }

private:
  std::size_t per_slot_;
  std::array<std::deque<std::string>, 4> topics_; ///< by urgency, in order
  std::map<std::string, std::string> payloads_;   ///< by topic
  instant slot_begins_{};                         ///< of the slot that is in progress or next
  std::size_t left_ = 0;                          ///< in that slot
  std::uint64_t replaced_ = 0;
};

} // namespace rubicon::bridge
