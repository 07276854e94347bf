// Actuation through one input channel of a gateway: each request has exactly one outcome (PXY-12).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "core/tuples/device_keys.hpp"

namespace rubicon::proxy {

/// How a request to an actuator ended.
enum class request_outcome : std::uint8_t {
  acknowledged, ///< the mote has it
  failed,       ///< the mote never acknowledged it
  unreachable,  ///< the mote is not there
  refused,      ///< the input does not know the word
  superseded,   ///< a newer request took its place before it was sent
  timeout,      ///< the gateway reported no outcome in time
  sent,         ///< towards a mote that acknowledges nothing
};

inline constexpr std::array<request_outcome, 7> all_request_outcomes{
    request_outcome::acknowledged, request_outcome::failed,     request_outcome::unreachable,
    request_outcome::refused,      request_outcome::superseded, request_outcome::timeout,
    request_outcome::sent};

/// The word in the outcome tuple.
[[nodiscard]] std::string_view to_string(request_outcome x);

/// A word somebody wants an actuator to obey.
struct request {
  std::size_t input = 0; ///< index in the class's inputs
  std::string word;
  bytes octets;    ///< what the word is for the mote
  instant asked{}; ///< set by input_channel::add()
};

/// Write these to the channel at the gateway.
struct submit {
  bytes octets;
  bool again = false; ///< what was written before has failed
};

/// A request has ended.
struct finished {
  std::size_t input = 0;
  std::string word;
  request_outcome outcome = request_outcome::failed;
  duration after{}; ///< since it was asked for
};

/// The requests on one channel of one mote. One is with the gateway at a time; behind it waits the
/// newest of each input, in order of arrival, so the queue is as long as the inputs are many.
///
///   idle --add--> unnumbered --status N--> numbered --N final--> finished, next request
///                     |                       |
///                     +--------timeout--------+-------------> finished, next request
///
/// With `retry_for`, what has failed, is unreachable or got no answer is written again after
/// retry_pause, as long as that is not later than so long after the first time; a newer request of
/// the same input takes its place at once.
///
/// The gateway answers `N pending`, then `N` and the outcome, N counting the writes it saw from
/// anybody. The first number that cannot be an older write's is taken for the request's:
/// - a number above all seen before, or
/// - a `pending` with a number not above them: the gateway has started to count anew.
/// Before any status was seen, only a `pending` counts: an outcome may be a predecessor's. Somebody
/// else's write on the same channel at the same moment cannot be distinguished from ours, nor can
/// the first answer to a request that timed out unnumbered once its successor has been written.
class input_channel {
public:
  using output = std::variant<submit, finished>;
  using outputs = std::vector<output>;

  static constexpr duration retry_pause = 1s;

  /// @param answer_timeout from a write to its latest outcome. From add() to that of the request it
  /// is so many times the sum of both as there are inputs, and once more: each may have a
  /// request before it.
  explicit input_channel(duration answer_timeout = 20s, duration retry_for = {})
      : answer_timeout_(answer_timeout), retry_for_(retry_for) {}

  /// For what is written from now on.
  void set_times(duration answer_timeout, duration retry_for) {
    answer_timeout_ = answer_timeout;
    retry_for_ = retry_for;
  }

  [[nodiscard]] outputs add(request x, instant now);
  [[nodiscard]] outputs on_status(const input_status& x, instant now);
  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()

  /// Requests that are not with the gateway end as unreachable; the one that is still waits for its
  /// outcome.
  [[nodiscard]] outputs drop_waiting(instant now);

  /// Another gateway is written to from now on (GW-14): it knows nothing of the request that went
  /// to the one before, which ends as failed.
  [[nodiscard]] outputs on_gateway_changed(instant now);

  /// When on_time() is due; nothing while idle.
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Requests without outcome.
  [[nodiscard]] std::size_t open() const { return waiting_.size() + (current_ ? 1 : 0); }

private:
  struct current_request {
    request what;
    instant expires;
    instant first;                              ///< when it was written for the first time
    std::optional<std::uint64_t> sequence = {}; ///< the gateway's number for it, once known
    std::optional<instant> again = {};          ///< set: it has failed, and is written again then
  };

  [[nodiscard]] bool note(const input_status& x);
  void conclude(request_outcome outcome, instant now, outputs& out);
  void finish(request_outcome outcome, instant now, outputs& out);
  void send_next(instant now, outputs& out);

  duration answer_timeout_;
  duration retry_for_;
  std::optional<current_request> current_;
  std::vector<request> waiting_;       ///< at most one per input, in order of asking
  std::optional<input_status> newest_; ///< highest number seen in this life of the gateway
};

} // namespace rubicon::proxy
