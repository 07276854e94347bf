// Writes to inputs of motes (`devices.$ID.input.$CH`): each has a number, a status tuple that says
// `N pending`, and one outcome.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "core/tuples/device_keys.hpp"
#include "gateway/occasion.hpp"
#include "gateway/others/relay.hpp"
#include "transport/messenger.hpp"

namespace rubicon::gateway {

/// A write without an outcome.
struct pending_input {
  mote_id mote;
  std::uint16_t channel = 0;
  std::uint64_t sequence = 0;
  std::optional<peer_id> asker = {}; ///< the gateway that has passed it on; sequence is its number
};

/// The writes whose outcome is not known: those sent to motes, those sent to motes with plain
/// programs, and those passed on to the gateway that leads.
class mote_inputs {
public:
  mote_inputs() = default;
  explicit mote_inputs(const gateway_config& config);

  /// A write of somebody else's. @returns nothing, counted: no room for another channel
  [[nodiscard]] std::optional<pending_input> begin(mote_id mote, std::uint16_t channel,
                                                   const occasion& at);

  /// A message to the mote has begun. @param id its outcome is passed to on_outcome()
  void sent(transport::ticket id, const pending_input& x) { sent_[id] = x; }
  void on_outcome(const transport::outcome& x, const occasion& at);

  void send_to_plain(const pending_input& x, byte_view octets, const occasion& at);
  /// @param arrived whether the mote has it, as far as anybody can know
  void on_plain_done(std::uint64_t number, bool arrived, const occasion& at);

  /// @param leader nothing: no gateway of the island leads
  void pass_on(const pending_input& x, std::optional<peer_id> leader, byte_view octets,
               const occasion& at);
  void on_relayed(const relayed_outcome& x, const occasion& at);

  /// The outcome of a write that is in none of the lists above.
  void report(const pending_input& x, input_outcome outcome, const occasion& at) const;

  /// Outcomes of messages and of what was passed on will not be known: they have failed.
  void fail_all(const occasion& at);

  void on_time(const occasion& at); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  /// Passed on to the gateway that leads.
  struct relayed {
    pending_input what;
    instant expires;
  };

  [[nodiscard]] duration relay_wait(mote_id mote) const;

  island_id island_;
  std::size_t outstanding_max_ = 0; ///< passed on at the same time
  std::size_t channels_max_ = 0;    ///< of motes, ever written to
  duration relay_wait_{};
  transport::answer_slacks slacks_ = {};
  std::map<std::pair<mote_id, std::uint16_t>, std::uint64_t> sequences_;
  std::map<transport::ticket, pending_input> sent_;
  std::map<std::uint64_t, pending_input> plain_; ///< by the number given
  std::uint64_t plain_number_ = 0;
  std::map<std::uint32_t, relayed> relayed_; ///< by the number given
  std::uint32_t relay_number_ = 0;
};

} // namespace rubicon::gateway
