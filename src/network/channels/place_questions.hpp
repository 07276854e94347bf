// Channels that are not begun before the sink has answered where their destinations are.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "network/channels/channel_message.hpp"

namespace rubicon::network {

struct awaited_channel {
  channel_id channel;
  mote_id destination;
  channel_schedule schedule;
  duration expiry{};
};

/// One whose time is over: the sink is asked once more, or it is begun without a place.
struct overdue_channel {
  awaited_channel what;
  bool is_asked = false;
};

/// Bounded: at most questions_max channels. The sink is asked at once, or when there is a route to
/// it, and again while no answer comes. In a crowd, where floods are expensive, it is asked again
/// when it does not know the place, or we do not know ours.
class place_questions {
public:
  static constexpr unsigned asks_max = 2;
  static constexpr unsigned asks_in_crowd_max = 3;
  static constexpr duration gap = 5s; ///< in a crowd, after an answer that was of no use

  place_questions() = default;
  explicit place_questions(std::size_t questions_max) : questions_max_(questions_max) {}

  [[nodiscard]] bool is_full() const { return channels_.size() >= questions_max_; }

  /// @param due when an answer is overdue, or a route @pre !is_full()
  void add(const awaited_channel& x, bool is_asked, instant due);
  void remove(channel_id channel);

  /// There is a route. @returns the destinations to ask for now; answers are overdue at `due`
  [[nodiscard]] std::vector<mote_id> take_unasked(instant due);

  /// @param is_useless in a crowd: the place is not known, or our own is not
  /// @returns the channels to begin now
  [[nodiscard]] std::vector<awaited_channel> on_answer(mote_id destination, bool is_useless,
                                                       instant now);

  /// @param due when an answer to those that are asked now is overdue
  [[nodiscard]] std::vector<overdue_channel> on_time(bool is_crowd, instant due, instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  struct question {
    awaited_channel channel;
    instant due;
    unsigned asks = 0; ///< sent to the sink: none before there is a route to it
  };

  [[nodiscard]] static bool may_ask_again(const question& x, bool is_crowd) {
    return x.asks > 0 && x.asks < (is_crowd ? asks_in_crowd_max : asks_max);
  }

  std::size_t questions_max_ = 0;
  std::vector<question> channels_;
};

} // namespace rubicon::network
