// Two peers with one id (RTE-08, IF-12, ADR-02): which of them leaves it to the other, and for how
// long.
//
// A magic number that has been followed by another one never returns unless two live peers share an
// id. A peer that notices notifies both, with the record of the other; they settle it between them
// by a rule that both can follow: who has come to the network lately leaves, of two alike the one
// with the higher magic number. A peer that cannot leave, being no Rubicon peer, is left the id.
// Who has left tries again after a while, as a newcomer, and so takes over when the other is gone.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/wire/host_record.hpp"

namespace rubicon::peis {

/// We may use our id again.
struct id_regained {};

class id_rivalry {
public:
  /// An id_taken with `stays_away` means: keep off the network, without a message of exit, which
  /// would be taken for the other's. id_regained follows.
  using output = std::variant<id_taken, id_regained>;
  using outputs = std::vector<output>;

  id_rivalry() = default;
  /// @param magic our own
  id_rivalry(std::int32_t magic, instant now) : magic_(magic), joined_(now) {}

  /// A sign that another peer lives under our id.
  [[nodiscard]] outputs note(const host_record& other, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] bool is_away() const { return away_until_.has_value(); }

  /// We leave the network, and mind it no more.
  void end() {
    ended_ = true;
    other_.reset();
  }

private:
  struct rival {
    host_record record;
    instant first; ///< sign of it
    instant last;
    instant checked; ///< when it was last judged
  };

  [[nodiscard]] std::optional<instant> yields_at() const;

  std::int32_t magic_ = 0;
  instant joined_;                       ///< the network, or came back to it
  std::optional<std::int32_t> reported_; ///< magic of the last peer that was seen using our id
  std::optional<rival> other_;
  std::optional<instant> away_until_;
  duration away_for_{}; ///< the last time
  bool ended_ = false;
};

} // namespace rubicon::peis
