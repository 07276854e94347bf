// The tuples in which a kernel reports its state (docs/peis-wire.md 18, TUP-22, SCH-06).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "peis/p2p/p2p.hpp"
#include "peis/space/tuple_space.hpp"

namespace rubicon::peis {

/// kernel.step-time, .traffic, .connections (each 5 s), .routingTable (10 s), .subscribers and
/// .all-keys (when changed, at most once a second; real kernels report each change of keys at
/// once).
///
/// A real kernel computes them always. Here one is computed when it is due and watched, or when it
/// is read and older than its period: rates are then those since the time before. Without watchers
/// there is no deadline.
class kernel_statistics {
public:
  using texts = std::vector<std::pair<key, std::string>>;

  kernel_statistics() = default;
  explicit kernel_statistics(instant now);

  /// The owner's main loop has run for this long (SCH-06).
  void note_step(duration length) {
    step_seconds_ = 0.9 * step_seconds_ + 0.1 * std::chrono::duration<double>(length).count();
  }

  /// Which are watched; cheap unless subscriptions have changed.
  void follow(const tuple_space& tuples);

  /// All there are, with their first values.
  [[nodiscard]] texts initial(const p2p& network, const tuple_space& tuples, instant now);

  /// Those that are watched and due.
  [[nodiscard]] texts due(const p2p& network, const tuple_space& tuples, instant now);

  /// Those of a pattern that are not watched and whose values are too old for a reader.
  [[nodiscard]] texts stale(const key& pattern, const p2p& network, const tuple_space& tuples,
                            instant now);

  [[nodiscard]] std::optional<instant> deadline(const tuple_space& tuples) const;

private:
  enum class kind : std::uint8_t { step_time, traffic, connections, routes, subscribers, all_keys };
  struct item {
    key name;
    duration period{};
    instant computed;
    std::uint64_t version = 0; ///< of what it was computed from, if sent when changed
    bool watched = false;
    std::size_t size = 0; ///< of the last text: a long one is sent less often
  };
  struct octets {
    std::uint64_t in = 0;
    std::uint64_t out = 0;
  };

  [[nodiscard]] static std::uint64_t version_of(kind which, const tuple_space& tuples);
  [[nodiscard]] std::optional<instant> due_at(kind which, const tuple_space& tuples) const;
  [[nodiscard]] std::string compute(kind which, const p2p& network, const tuple_space& tuples,
                                    instant now);
  [[nodiscard]] std::string text_of(kind which, const p2p& network, const tuple_space& tuples,
                                    double seconds);
  [[nodiscard]] std::string traffic(const p2p& network, double seconds);
  [[nodiscard]] std::string connections(const p2p& network, double seconds);

  std::array<item, 6> items_;
  std::uint64_t followed_version_ = 0;
  double step_seconds_ = 0;
  octets traffic_before_;
  std::map<link_id, octets> links_before_;
};

} // namespace rubicon::peis
