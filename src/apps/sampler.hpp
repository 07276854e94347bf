// Samples transducers and sends their counts to the gateway.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "apps/application.hpp"
#include "core/describe/changes.hpp"
#include "core/numbers/running_mean.hpp"

namespace rubicon::apps {

/// Samples and sends while its mote is in the island and, if so configured, somebody subscribes to
/// its channel; at the period that somebody has asked for (IF-04), or its own. Periods start at a
/// random phase. With a dead band it samples as often, but sends only what differs enough from what
/// it has sent, the first of a phase, and what would come too late if it waited for the next.
class sampler final : public application {
public:
  /// @param config not nullptr; samplers that are alike share one
  sampler(std::shared_ptr<const sampler_config> config, random_stream rng);

  /// Some of its settings are others from now on. A new period begins at a random phase.
  void change(const keys::key_changes& settings);

  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override;

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void outputsWanted(std::span<const communication::output_wanted> all) override;
  void transducersRead(std::span<const std::int16_t> counts, std::uint32_t time_ms) override;

private:
  void on_start(instant) override {}
  [[nodiscard]] std::optional<duration> period() const; ///< nothing: it is not to send
  [[nodiscard]] bool is_news(const std::vector<std::int16_t>& counts) const;

  std::shared_ptr<const sampler_config> config_;
  random_stream rng_;
  std::vector<running_mean> means_; ///< of each transducer; empty: counts go as they are
  bool in_island_ = false;
  std::optional<communication::output_wanted> wanted_; ///< of its channel, by the gateway
  bool begins_ = false;                                ///< its periods do, at the next on_time()
  std::optional<duration> every_;                      ///< nothing: it rests
  instant next_period_;
  instant due_;                    ///< next_period_ and its jitter
  instant sampled_;                ///< the last time
  instant sent_at_;                ///< when that was,
  std::vector<std::int16_t> sent_; ///< what was sent last; empty: nothing in this phase
};

} // namespace rubicon::apps
