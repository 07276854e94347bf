// Links that may be dead: those that are silent, and those to real kernels that are suspect.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Marked neighbours beat, and are given up soon. With real kernels neither end of a dead link
/// knows: after a cut, both wait for TCP's next try, which comes ever later. Such a link is in
/// doubt when no sign of life comes, or nothing leaves: another is to be tried beside it.
class link_health {
public:
  /// All outlive this.
  link_health(const own_peer& own, link_table& links, const host_table& hosts)
      : own_(own), links_(links), hosts_(hosts) {}

  [[nodiscard]] bool is_marked(const connection& x) const; ///< its neighbour is of our kind

  void watch_silence(const connection& x);
  /// Links that are silent now, or do not let anything leave: they are to be closed.
  [[nodiscard]] std::vector<std::pair<link_id, close_cause>> take_silent(instant now);

  [[nodiscard]] bool can_be_suspected(const connection& x) const;
  [[nodiscard]] bool is_suspect(const connection& x, instant now) const;
  void watch_suspicion(const connection& x);
  struct suspects {
    std::vector<link_id> ask;    ///< a sign of life is to be asked for
    std::vector<link_id> beside; ///< another link is to be tried
  };
  [[nodiscard]] suspects take_suspects(instant now);

  [[nodiscard]] std::optional<instant> deadline() const;

private:
  [[nodiscard]] duration patience(const connection& x) const;
  [[nodiscard]] instant silence_deadline(const connection& x) const;
  [[nodiscard]] instant drain_deadline(const connection& x) const;
  [[nodiscard]] instant suspicion_begins(const connection& x) const;
  [[nodiscard]] instant asks_at(const connection& x) const;
  [[nodiscard]] instant next_suspicion_of(const connection& x) const;

  const own_peer& own_;
  link_table& links_;
  const host_table& hosts_;
  std::optional<instant> next_silence_check_;
  std::optional<instant> next_suspicion_;
};

} // namespace rubicon::peis
