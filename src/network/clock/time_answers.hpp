// The beacons by which a mote that knows the time answers those that ask for it (CLK-04).
#pragma once

#include <optional>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::network {

/// Where radios sleep a window is short, and so is the time for which the other listens: the answer
/// is repeated. Where they are always on many may answer, and the other asks again.
struct answers_config {
  duration spread = 250ms;                  ///< an answer leaves within this time
  duration gap = 1s;                        ///< between two
  unsigned each = 1;                        ///< answers to a request
  static constexpr unsigned others_max = 2; ///< answers of others: then ours is not needed
};

class time_answers {
public:
  time_answers() = default;
  time_answers(answers_config config, instant now)
      : config_(config), answered_(now - answers_config().gap) {}

  /// Another needs the time. @param asks it has asked for it
  /// @returns whether an answer is due that was not
  bool on_request(bool asks, instant now, random_stream& rng);
  /// Another mote has answered.
  void on_answer();
  /// A beacon leaves now: it is the answer.
  void on_beacon(instant now);

  [[nodiscard]] std::optional<instant> due() const { return due_; }
  [[nodiscard]] bool is_due(instant now) const { return due_ && *due_ <= now; }

private:
  answers_config config_;
  std::optional<instant> due_;
  unsigned left_ = 0;   ///< of ours, the one that is due among them
  unsigned others_ = 0; ///< received since ours became due
  instant answered_;    ///< when one became due last
};

} // namespace rubicon::network
