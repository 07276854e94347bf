#include "mote/stack/cached_layer.hpp"

#include <utility>

namespace rubicon::mote {

std::optional<communication::layer_outputs> cached_layer::take_outputs() {
  if (!std::exchange(is_used_, false))
    return std::nullopt;
  ++turns_;
  auto outputs = layer_.take_outputs();
  deadline_ = layer_.deadline();
  wants_ticks_ = layer_.ports().synaptic.wants_ticks();
  return outputs;
}

} // namespace rubicon::mote
