// The PC of an island: the programs at its gateway, and the messages between motes and tuples.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "communication/layer_totals.hpp"
#include "communication/pc.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "gateway/gateway_config.hpp"
#include "network/sink_event.hpp"

namespace rubicon::gateway {

/// A communication::pc of which each term is another incarnation (GW-14). What its programs do not
/// provide is received for tuples: it waits here until the gateway takes it.
class island_pc {
public:
  using observer = std::function<void(const communication::program_note&)>;

  island_pc();
  /// @param first random numbers of its first term; @param further of those after it
  island_pc(const gateway_config& config, random_stream first, random_stream further);
  island_pc(island_pc&& x) noexcept;
  island_pc& operator=(island_pc&& x) noexcept;
  ~island_pc();

  void observe(observer x);

  /// The PC of this term: what it receives and sends, and its programs.
  [[nodiscard]] communication::pc& term() { return pc_; }

  /// A message for a mote that tuples are the reason of; the next flush() of the term sends it.
  /// @returns its ticket; nothing: it has failed
  [[nodiscard]] std::optional<transport::ticket> send(mote_id to, byte_view octets,
                                                      std::uint8_t am_type);
  [[nodiscard]] std::vector<transport::received> take_received();
  [[nodiscard]] std::vector<transport::outcome> take_outcomes();
  void discard(); ///< all that could be taken

  /// The gateway's life begins: network time is given after clock_wait, if it was started before.
  void start(instant now);
  /// Another incarnation, as one that was just started: what the last term has not finished is lost
  /// with it.
  [[nodiscard]] communication::outputs begin_term(std::uint32_t term, bool is_line_up, instant now);

  [[nodiscard]] communication::outputs on_clock(duration offset, instant now);
  /// Nothing while others are about to correct it: a sink goes on with the time that it knows.
  [[nodiscard]] std::optional<network::time_answer> answer_to(const network::time_request& x,
                                                              instant now) const;

  [[nodiscard]] std::optional<instant> deadline() const { return pc_.deadline(); } ///< the term's
  [[nodiscard]] std::optional<duration> clock_offset() const { return clock_offset_; }
  [[nodiscard]] const communication::layer& above() const { return pc_.above(); }
  [[nodiscard]] std::size_t outstanding() const {
    return above().ports().messages.core().outstanding();
  }
  // Of all terms.
  [[nodiscard]] communication::layer_totals layer_counters() const;
  [[nodiscard]] communication::pc_counters counters() const;

private:
  class messages_for_tuples;

  island_id island_;
  communication::pc_config config_; ///< of the first term
  communication::pc pc_;
  std::unique_ptr<messages_for_tuples> messages_;
  observer observer_;
  random_stream rng_;                     ///< of further terms
  communication::layer_totals earlier_;   ///< of terms that are over
  communication::pc_counters earlier_pc_; ///< the same
  bool was_started_before_ = false;
  duration clock_wait_{};
  std::optional<duration> clock_offset_; ///< network time is so much ahead
  instant clock_valid_from_;
};

} // namespace rubicon::gateway
