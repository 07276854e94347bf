// How often a frame survives noise and interference.
#pragma once

#include <span>

#include "radio/parameters.hpp"

namespace rubicon::radio {

/// Bit error rate of the 2.4 GHz O-QPSK PHY, IEEE 802.15.4-2006 E.4.1.8:
///   8/15 * 1/16 * sum over k = 2..16 of (-1)^k C(16,k) exp(20 sinr (1/k - 1))
/// @param sinr signal to interference and noise, as a ratio of powers, >= 0
/// @returns 0..0.5
[[nodiscard]] double bit_error_rate(double sinr);

/// TOSSIM's chance that one drawing lets a frame pass (tinyos.md 7.2).
/// @param snr_db in decibels
[[nodiscard]] double tossim_reception_rate(double snr_db);

/// The SINR at which 1 % of the frames with a PSDU of 20 octets are lost. That is how IEEE
/// 802.15.4-2006 6.1.7 defines the sensitivity, and what data sheets state it for; so a receiver
/// has noise of its own (and losses that count as noise) of its sensitivity divided by this.
/// @returns a ratio of powers
[[nodiscard]] double sinr_at_sensitivity(error_curve curve);

/// Damage adds up over a frame; it survives with the chance exp(-damage).
///
/// For oqpsk, damage is counted per bit on the air (preamble, SFD and length included: a frame
/// whose start is spoiled is lost too): -ln(1 - bit error rate). For tossim it is counted per
/// drawing, -ln of the curve: two drawings a data frame, one an ack, spread evenly over the frame
/// (tinyos.md 7.2; with steady noise that gives TOSSIM's prr squared, and cubed with the ack).
///
/// A cheap value: all models share one table per curve.
class error_model {
public:
  explicit error_model(error_curve curve = error_curve::oqpsk);

  /// Damage of one bit or one drawing, interpolated in a table: within 0.1 % of the curve where
  /// damage matters; 0 above the table's end, where 1016 bits survive with 1 - 10^-9.
  /// @param sinr as a ratio of powers, >= 0, infinity too
  /// @returns 0..10^4, falling; finite for 0 too
  [[nodiscard]] double damage(double sinr) const;

  /// How many bits or drawings a part of a frame is. @pre frame_bits > 0
  [[nodiscard]] double weight(double part_bits, double frame_bits, bool is_ack) const {
    if (curve_ == error_curve::oqpsk)
      return part_bits;
    return (is_ack ? 1 : 2) * part_bits / frame_bits;
  }

private:
  error_curve curve_;
  std::span<const float> table_; ///< at 0, 1, 2, ... steps of sinr
};

} // namespace rubicon::radio
