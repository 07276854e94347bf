// What comes of one session over UDP, put in order (UDP-01).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

#include "core/bytes.hpp"
#include "peis/udp/udp_datagram.hpp"

namespace rubicon::peis {

/// Keeps parts that come before others until those are there, and the octets in order until they
/// are taken. Knows what the next report says, and when one is due.
class udp_receiver {
public:
  enum class outcome : std::uint8_t { taken, repeated, out_of_window };

  udp_receiver() = default;
  /// @param parts_max that wait, of each sort: out of order, and for their owner
  explicit udp_receiver(std::size_t parts_max) : parts_max_(parts_max) {}

  /// @pre x carries a part
  [[nodiscard]] outcome on_part(const udp_segment& x);

  /// The octets that have come, in order, since the last call. @param next memory for those to come
  [[nodiscard]] bytes take(bytes next);
  [[nodiscard]] bool has_octets() const { return !in_order_.empty(); }

  /// Parts that wait for others before them.
  [[nodiscard]] std::size_t early() const { return early_.size(); }

  /// A report leaves in each segment.
  void report_in(udp_segment& x);
  /// Of the parts behind the first that has not come, as udp_segment::content.
  [[nodiscard]] bytes bitmap() const;

  [[nodiscard]] bool is_report_due() const { return report_due_; }
  /// It has left. @param whole with the bitmap
  void note_reported(bool whole) { report_due_ = report_due_ && !whole && !early_.empty(); }

private:
  void append_in_order(byte_view content);
  [[nodiscard]] std::uint16_t credit() const;

  std::size_t parts_max_ = 0;
  bytes in_order_;
  std::map<std::uint64_t, bytes> early_; ///< by sequence
  std::uint64_t expected_ = 0;
  std::uint64_t newest_ = 0; ///< transmission of the other side
  std::uint32_t count_ = 0;
  std::uint16_t given_credit_ = 0;
  bool report_due_ = false;
};

} // namespace rubicon::peis
