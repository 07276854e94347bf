// Connect messages that are sent to all motes, as one of these has received them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "core/address.hpp"
#include "core/time.hpp"
#include "network/channels/channel_message.hpp"

namespace rubicon::network {

/// Of a flooded connect message that we have said, too.
class flood_copies {
public:
  static constexpr unsigned enough = 3; ///< received: in a crowd it need not be said any more

  /// Another one. We say `own_hops + 1`, and who passes it on one more.
  void note(std::uint8_t hops, std::uint8_t own_hops) {
    ++copies_;
    passed_on_ = passed_on_ || hops >= own_hops + 2;
  }

  [[nodiscard]] unsigned received() const { return copies_; }

  /// How often it is to be said: it is not acknowledged.
  [[nodiscard]] unsigned rounds() const { return passed_on_ || copies_ >= enough ? 2 : 5; }

private:
  unsigned copies_ = 1;
  bool passed_on_ = false; ///< one of them by a mote that had it from us, or might have
};

/// A flooded connect message that was received first from `previous`.
struct flood_offer {
  mote_id previous;
  connect_message request;
  instant end; ///< what has not been taken up by then is void
  flood_copies heard;
};

/// Floods of whose channels we may come to be part. Bounded: what comes beyond is left to others.
class flood_offers {
public:
  flood_offers() = default;
  explicit flood_offers(std::size_t offers_max) : offers_max_(offers_max) {}

  [[nodiscard]] bool is_full() const { return offers_.size() >= offers_max_; }

  /// nullptr: there is none.
  [[nodiscard]] flood_offer* find(channel_id channel) {
    const auto found = offers_.find(channel);
    return found != offers_.end() ? &found->second : nullptr;
  }
  [[nodiscard]] const flood_offer* find(channel_id channel) const {
    const auto found = offers_.find(channel);
    return found != offers_.end() ? &found->second : nullptr;
  }

  /// @pre !is_full()
  void add(channel_id channel, const flood_offer& x) { offers_[channel] = x; }

  /// The destination has answered by us.
  [[nodiscard]] std::optional<flood_offer> take_up(channel_id channel) {
    const auto found = offers_.extract(channel);
    return found.empty() ? std::nullopt : std::optional(found.mapped());
  }

  void on_time(instant now) {
    std::erase_if(offers_, [now](const auto& x) { return x.second.end <= now; });
  }

  [[nodiscard]] std::optional<instant> deadline() const {
    std::optional<instant> next;
    for (const auto& [id, x] : offers_)
      next = earliest(next, x.end);
    return next;
  }

private:
  std::size_t offers_max_ = 0;
  std::map<channel_id, flood_offer> offers_;
};

} // namespace rubicon::network
