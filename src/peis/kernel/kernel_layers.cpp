#include "peis/kernel/kernel_layers.hpp"

#include <utility>

namespace rubicon::peis {

kernel_layers::kernel_layers(kernel_config wanted, random_stream rng, instant now)
    : config(std::move(wanted)), network(config.network, rng, now),
      tuples(config.tuples, config.network.id, config.network.clock_offset), statistics(now) {
  network.share_memory(tuples.memory());
}

cause kernel_layers::refusal(const result<key>& name) {
  if (network.view().own.left)
    return cause::left;
  if (name)
    return cause::none;
  ++refused;
  return cause::bad_key;
}

kernel_counters kernel_layers::counters() const {
  kernel_counters all{network.view().own.counters, tuples.counters(), ports.unhooked()};
  all.tuples.refused += refused;
  all.tuples.bad_meta_tuples = indirect.malformed();
  return all;
}

} // namespace rubicon::peis
