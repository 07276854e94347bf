// Which motes are to send on which output channels: those that somebody subscribes to (D1.1 5.4;
// GW-10), at the rate that somebody has asked for (IF-04).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "communication/outputs_wanted.hpp"
#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::gateway {

struct output_requests_config {
  duration hesitation = 100ms;    ///< after a change: subscriptions come in groups
  duration retry = 10s;           ///< after a request that failed
  std::size_t in_flight_max = 16; ///< motes asked at the same time
  duration restart_pause =
      5s; ///< after a restart: subscribers come back before any mote is asked to stop
};

/// Sends each listed mote all that is wanted of it whenever that differs from what it last
/// acknowledged. One request is in flight for each mote.
class output_requests {
public:
  using wanted = std::vector<communication::output_wanted>;

  struct request {
    mote_id mote;
    wanted outputs;
  };

  output_requests() = default;
  /// @param restarted motes may know requests of an earlier life of ours
  output_requests(output_requests_config config, bool restarted, instant now);

  /// Keys and patterns subscribed to, in lower case. Those of output tuples count.
  void on_subscribers(std::span<const std::string> keys, instant now);

  /// @param period 0: the period of the mote
  void on_period(mote_id mote, std::uint16_t channel, std::chrono::milliseconds period,
                 instant now);

  void on_listed(mote_id mote, std::uint32_t incarnation, instant now);
  void on_unlisted(mote_id mote);

  /// Motes may have been asked by another gateway since, and those asked by us will not answer.
  void forget_confirmed(instant now);

  /// Requests to be sent now; the outcome of each is passed to on_outcome().
  [[nodiscard]] std::vector<request> due(instant now);
  void on_outcome(mote_id mote, bool acked, instant now);

  [[nodiscard]] std::optional<instant> deadline() const;

  /// What is wanted of a mote now, ascending by channel.
  [[nodiscard]] wanted wanted_of(mote_id mote) const;

private:
  struct entry {
    bool listed = false;
    std::uint32_t incarnation = 0;
    std::optional<wanted> confirmed; ///< last acknowledged; nothing: not known
    std::optional<wanted> in_flight;
    std::uint32_t asked = 0;    ///< incarnation that the request in flight is for
    std::optional<instant> due; ///< as in due_
  };

  void review(mote_id mote, entry& x, instant at);
  void schedule(mote_id mote, entry& x, std::optional<instant> at);
  void review_all(instant at);

  output_requests_config config_;
  bool restarted_ = false;
  instant withheld_until_;
  std::map<mote_id, entry> motes_;
  std::set<std::pair<instant, mote_id>> due_;
  std::map<mote_id, std::set<std::uint16_t>> channels_; ///< subscribed to
  std::set<std::uint16_t> channels_of_all_;             ///< of every mote
  std::map<std::pair<mote_id, std::uint16_t>, std::chrono::milliseconds> periods_;
  std::size_t in_flight_ = 0;
};

} // namespace rubicon::gateway
