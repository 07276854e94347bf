// The radio's two books. Every copy of a frame and every request ends in exactly one of their
// lines.
#pragma once

#include <cstdint>

namespace rubicon::radio {

/// Copies of frames: one for each radio in range of a transmission, booked with that radio when the
/// frame ends. Acks are frames too.
///   sent = delivered + loss + collision + half_duplex + off + filtered + overflow + duplicate
struct copy_book {
  std::uint64_t sent = 0;        ///< a radio in range was on the air when a transmission ended
  std::uint64_t delivered = 0;   ///< data handed to the mote, acks that completed a request
  std::uint64_t loss = 0;        ///< random, channel_config::loss
  std::uint64_t collision = 0;   ///< overlapped at the receiver with another frame in its range
  std::uint64_t half_duplex = 0; ///< the receiver was sending at some time during the frame
  std::uint64_t off = 0;         ///< receiver or sender was off at some time during the frame
  std::uint64_t filtered = 0;    ///< for another mote or PAN, or an ack nobody here waits for
  std::uint64_t overflow = 0;    ///< no receive slot was free
  std::uint64_t duplicate = 0;   ///< repeated by the sender because it missed the ack

  [[nodiscard]] bool balanced() const;
  copy_book& operator+=(const copy_book& x);
  friend bool operator==(const copy_book&, const copy_book&) = default;
};

/// Requests to send, booked with the sender.
///   requests = sent + no_ack + channel_access_failure + queue_full + aborted + open
struct request_book {
  std::uint64_t requests = 0;
  std::uint64_t sent = 0;
  std::uint64_t no_ack = 0;
  std::uint64_t channel_access_failure = 0;
  std::uint64_t queue_full = 0;
  std::uint64_t aborted = 0;
  std::uint64_t open = 0; ///< queued or under way, counted where they wait

  [[nodiscard]] bool balanced() const;
  request_book& operator+=(const request_book& x);
  friend bool operator==(const request_book&, const request_book&) = default;
};

/// What one radio, the radios of one PAN or all radios have counted.
struct books {
  copy_book copies;                ///< that came to these radios, from whichever PAN
  request_book requests;           ///< made to these radios
  std::uint64_t transmissions = 0; ///< frames they put on the air, retries and acks included
  std::uint64_t acks = 0;          ///< of these, acks
  std::uint64_t acks_received = 0; ///< copies delivered that were acks

  [[nodiscard]] bool balanced() const { return copies.balanced() && requests.balanced(); }
  books& operator+=(const books& x);
  friend bool operator==(const books&, const books&) = default;
};

} // namespace rubicon::radio
