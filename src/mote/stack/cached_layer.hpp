// The Communication Layer of a mote, as its node uses it.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "communication/layer.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::mote {

/// Most frames do not concern the layer: its deadline, and whether it wants ticks, are kept while
/// it is not used.
class cached_layer {
public:
  cached_layer(const communication::layer_config& config, random_stream rng)
      : layer_(config, rng) {}

  /// For an input or a command; take_outputs() follows.
  [[nodiscard]] communication::layer& use() {
    is_used_ = true;
    return layer_;
  }
  /// As layer::observe(), which is no use.
  void observe(communication::program_observer observer) { layer_.observe(std::move(observer)); }
  [[nodiscard]] const communication::layer& view() const { return layer_; }

  /// Nothing: it was not used since the last call.
  [[nodiscard]] std::optional<communication::layer_outputs> take_outputs();

  [[nodiscard]] std::optional<instant> deadline() const {
    return is_used_ ? layer_.deadline() : deadline_;
  }
  [[nodiscard]] bool wants_ticks() const {
    return is_used_ ? layer_.ports().synaptic.wants_ticks() : wants_ticks_;
  }

  /// How often it was used.
  [[nodiscard]] std::uint32_t turns() const { return turns_; }

private:
  communication::layer layer_; ///< programs point into it
  bool is_used_ = false;
  std::uint32_t turns_ = 0;
  bool wants_ticks_ = false;
  std::optional<instant> deadline_;
};

} // namespace rubicon::mote
