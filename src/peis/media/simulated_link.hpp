// One end of a simulated link: when what is sent has left and arrives, and what is lost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "peis/media/simulated_media.hpp"

namespace rubicon::peis {

/// So many octets will have left: kernel::on_link_sent() is due.
struct octets_leave {
  instant at;
  std::size_t octets = 0;
};

/// They reach the far end.
struct octets_arrive {
  instant at;
  payload octets;
};

/// Whole packages that do not.
struct packages_lost {
  bytes octets;
  std::size_t count = 0;
};

/// Nothing of this does: the link is cut.
struct octets_cut {
  payload octets;
};

/// Octets leave one after another at the link's rate, and arrive a delay later, if the condition of
/// the link lets them.
class simulated_link {
public:
  using output = std::variant<octets_leave, octets_arrive, packages_lost, octets_cut>;
  using outputs = std::vector<output>;

  simulated_link() = default;
  /// @param rate_bps 0: unlimited
  simulated_link(link_role role, link_condition condition, duration delay, std::uint64_t rate_bps)
      : condition_(condition), request_is_next_(role == link_role::initiator), delay_(delay),
        rate_bps_(rate_bps) {}

  void set_condition(link_condition x) { condition_ = x; }

  /// @param rng says which packages are lost; a connect request never is
  [[nodiscard]] outputs send(payload octets, instant now, random_stream& rng);

  /// When the far end is notified that this one was closed: after all that was sent. nullopt:
  /// never.
  [[nodiscard]] std::optional<instant> close(instant now) const;

private:
  link_condition condition_;
  bool request_is_next_ = false; ///< the next octets begin with a connect request
  duration delay_{};
  std::uint64_t rate_bps_ = 0;
  instant free_at_; ///< when what was handed out has left
};

} // namespace rubicon::peis
