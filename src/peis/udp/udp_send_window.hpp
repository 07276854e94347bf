// The parts of one session over UDP that the other side has not got, as far as is known (UDP-01).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/udp/udp_datagram.hpp"

namespace rubicon::peis {

/// Numbers parts and their transmissions. The other side's reports say which have come; what is
/// overtaken by far is lost, and leaves again.
///
///   add() --> lost --transmit()--> under way --acknowledge()--> arrived, gone with all before it
///               ^---find_losses()----+
class udp_send_window {
public:
  enum class state : std::uint8_t { under_way, lost, arrived };
  /// A report against those before it.
  enum class news : std::uint8_t { none, same, newer };

  struct acknowledged {
    std::size_t octets = 0;             ///< of parts that were not known to have come
    std::optional<duration> round_trip; ///< of the newest transmission that is reported
  };
  struct transmission {
    std::uint64_t number = 0; ///< of all of the session, from 1 on; the last 32 bits are never 0
    byte_view content;        ///< valid until the part is gone
    bool is_repeated = false;
  };

  /// Appends a part, which is to leave.
  void add(bytes content);
  [[nodiscard]] transmission transmit(std::uint64_t sequence, instant now);

  /// Whether only what has left is acknowledged.
  [[nodiscard]] bool is_possible(const udp_segment& x) const;
  /// @pre is_possible(x), here and below
  [[nodiscard]] news on_report(const udp_segment& x);
  [[nodiscard]] acknowledged acknowledge(const udp_segment& x, instant now);

  /// Lost is what was sent before a part that has come, and is out for longer than reordering
  /// takes.
  void find_losses(instant now, duration lost_after);
  /// When find_losses() is due.
  [[nodiscard]] std::optional<instant> deadline() const { return loss_at_; }

  [[nodiscard]] std::uint64_t first() const { return first_; } ///< sequence of the oldest part
  [[nodiscard]] std::uint64_t next() const { return first_ + parts_.size(); } ///< of the next one
  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  [[nodiscard]] state state_of(std::uint64_t sequence) const;
  [[nodiscard]] std::size_t under_way() const { return under_way_; }
  [[nodiscard]] std::size_t lost() const { return lost_; }

  [[nodiscard]] std::uint64_t sent() const { return sent_; }     ///< transmissions
  [[nodiscard]] std::uint64_t newest() const { return newest_; } ///< that has come, as reported
  [[nodiscard]] std::uint64_t count() const { return count_; }   ///< that have come, as reported

private:
  struct part {
    bytes content;
    std::uint64_t number = 0; ///< of the last transmission
    instant sent{};
    state now = state::lost;
  };

  void note_arrival(part& x, instant now, acknowledged& out);

  std::deque<part> parts_;
  std::uint64_t first_ = 0;
  std::size_t under_way_ = 0;
  std::size_t lost_ = 0;
  std::uint64_t sent_ = 0;
  std::uint64_t newest_ = 0;
  std::uint64_t count_ = 0;
  std::optional<instant> loss_at_; ///< when a part will count as lost
};

} // namespace rubicon::peis
