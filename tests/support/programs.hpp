// Programs of the Communication Layer on a mote: with nothing below it, or in an island.
#pragma once

#include <algorithm>
#include <variant>

#include "communication/layer.hpp"
#include "core/numbers/random.hpp"
#include "support/catch.hpp"
#include "support/island_fixture.hpp"
#include "support/recorder.hpp"

namespace rubicon::test {

/// The layer of mote 7 without anything below it.
struct lone_layer {
  lone_layer() { program.layer = core.attach(program); }

  static communication::layer_config config() {
    communication::layer_config x;
    x.self = mote_id{7};
    return x;
  }

  communication::interface& api() { return *program.layer; }

  recorder program;
  communication::layer core{config(), random_stream(1)};
  instant now;
};

/// Island 3.
inline void join(lone_layer& x) {
  x.core.on_initialised(true, x.now);
  x.core.on_joined(island_id{3}, x.now);
  static_cast<void>(x.core.take_outputs());
}

template <class T>
[[nodiscard]] std::size_t count(const communication::layer_outputs& outputs) {
  return static_cast<std::size_t>(
      std::ranges::count_if(outputs, [](const auto& x) { return std::holds_alternative<T>(x); }));
}

/// A program on a mote gives commands.
template <class Commands>
auto act(island_fixture& world, mote_id who, Commands commands) {
  auto& here = world.at(who);
  here.begin(world.own_time(who));
  const auto result = commands();
  world.perform(who, here.settle(world.own_time(who)));
  return result;
}

inline void settle(island_fixture& x, std::size_t motes) {
  REQUIRE(x.run_until([&] { return x.root().members() == motes; }, 3min));
  x.run_for(1min);
}

} // namespace rubicon::test
