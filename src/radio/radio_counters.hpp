// What a radio counts. Every copy of a frame and every request ends in exactly one of their
// lines.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/describe/fields.hpp"
#include "radio/medium/topology.hpp"

namespace rubicon::radio {

/// What became of one copy of a frame at one radio in reach. Of several causes the first in time
/// counts.
enum class copy_outcome : std::uint8_t {
  delivered,    ///< data handed to the mote, an ack that completed a request
  weak,         ///< below the sensitivity, or spoiled by noise alone
  loss,         ///< the link's own chance (channel_config::loss, link_override)
  collision,    ///< spoiled by interference
  captured,     ///< the receiver was busy with another frame, or left this one for a stronger one
  half_duplex,  ///< the receiver was sending at some time during the frame
  off,          ///< receiver or sender was off at some time during the frame
  filtered,     ///< for another mote or PAN, or an ack nobody here waits for
  overflow,     ///< no receive slot was free
  duplicate,    ///< repeated by the sender because it missed the ack
  out_of_reach, ///< there was no copy: the radio is too far away; not counted
};

inline constexpr std::size_t copy_outcomes = 10; ///< those that are counted

/// As the report names them.
[[nodiscard]] std::string to_string(copy_outcome x);

/// Copies of frames: one for each radio in reach of a transmission, booked when the frame ends.
/// Acks are frames too. sent = the sum of all outcomes.
struct copy_counters {
  std::uint64_t sent = 0;
  std::array<std::uint64_t, copy_outcomes> ended{}; ///< by outcome

  [[nodiscard]] std::uint64_t of(copy_outcome x) const {
    return ended[static_cast<std::size_t>(x)];
  }
  [[nodiscard]] bool balanced() const;
  friend bool operator==(const copy_counters&, const copy_counters&) = default;
};
RUBICON_FIELDS(copy_counters, sent, ended);

/// The copies on all links out of one radio. `sent` is counted once a frame, the outcomes one by
/// one, so that each link is checked against something. Takes room only for outcomes that have
/// occurred.
class link_counters {
public:
  /// From now on it is about the links to these radios; what was counted is forgotten.
  /// @param to not nullptr
  void begin(const std::shared_ptr<const hearers>& to) {
    to_ = to;
    frames_ = 0;
    all_filtered_ = 0;
    rows_ = std::make_unique<std::array<row, copy_outcomes>>();
  }

  [[nodiscard]] bool is_about(const std::shared_ptr<const hearers>& to) const { return to_ == to; }

  void count_frame() { ++frames_; }

  /// @param place of the radio in the list
  void count(std::size_t place, copy_outcome x) {
    auto& counts = (*rows_)[static_cast<std::size_t>(x)];
    if (counts.empty())
      counts.resize(to_->size());
    ++counts[place];
  }

  /// Counts the frame's copies on all links as filtered, but for those that except() names.
  void count_all_filtered() { ++all_filtered_; }
  void except(std::size_t place) {
    auto& counts = (*rows_)[filtered];
    if (counts.empty())
      counts.resize(to_->size());
    --counts[place]; // below zero, modulo 2^32, until what all have in common is added
  }

  [[nodiscard]] const hearers* to() const { return to_.get(); } ///< nullptr: nothing sent yet
  [[nodiscard]] copy_counters link(std::size_t place) const;

  /// Adds each link to what the radio has received that it leads to. @param f of a radio_index
  template <class ReceivedBy>
  void add_to(ReceivedBy f) const {
    if (rows_ == nullptr)
      return;
    for (const auto& each : *to_)
      f(each.radio).sent += frames_;
    for (std::size_t i = 0; i < copy_outcomes; ++i)
      if (i == filtered || !(*rows_)[i].empty())
        for (std::size_t place = 0; place < to_->size(); ++place)
          f((*to_)[place].radio).ended[i] += ended(place, i);
  }

private:
  using row = std::vector<std::uint32_t>; ///< empty or one count a link
  static constexpr auto filtered = static_cast<std::size_t>(copy_outcome::filtered);

  [[nodiscard]] std::uint32_t ended(std::size_t place, std::size_t outcome) const {
    const auto& counts = (*rows_)[outcome];
    return (counts.empty() ? 0 : counts[place]) + (outcome == filtered ? all_filtered_ : 0);
  }

  std::shared_ptr<const hearers> to_;
  std::uint64_t frames_ = 0;
  std::uint32_t all_filtered_ = 0; ///< frames, of which the filtered row has the exceptions
  std::unique_ptr<std::array<row, copy_outcomes>> rows_;
};

/// Requests to send that have failed, by cause, as the report names them.
struct failure_counters {
  std::uint64_t no_ack = 0;
  std::uint64_t channel_access_failure = 0;
  std::uint64_t queue_full = 0;
  std::uint64_t aborted = 0;

  friend bool operator==(const failure_counters&, const failure_counters&) = default;
};
RUBICON_FIELDS(failure_counters, no_ack, channel_access_failure, queue_full, aborted);

/// Requests to send, booked with the sender: requests = sent + those failed + open.
struct request_counters {
  std::uint64_t requests = 0;
  std::uint64_t sent = 0;
  failure_counters failed = {};
  std::uint64_t open = 0; ///< queued or in flight, counted where they wait

  [[nodiscard]] bool balanced() const;
  friend bool operator==(const request_counters&, const request_counters&) = default;
};
RUBICON_FIELDS(request_counters, requests, sent, failed, open);

/// What one radio, the radios of one PAN or all radios have counted.
struct radio_counters {
  copy_counters copies;            ///< that came to these radios, from whichever PAN
  request_counters requests;       ///< made to these radios
  std::uint64_t transmissions = 0; ///< frames they put on the air, retries and acks included
  std::uint64_t acks = 0;          ///< of these, acks
  std::uint64_t acks_received = 0; ///< copies delivered that were acks

  [[nodiscard]] bool balanced() const { return copies.balanced() && requests.balanced(); }
  friend bool operator==(const radio_counters&, const radio_counters&) = default;
};
RUBICON_FIELDS(radio_counters, copies, requests, transmissions, acks, acks_received);

} // namespace rubicon::radio
