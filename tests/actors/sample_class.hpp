// A proxy class for the tests of proxies and of their manager.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "actors/messages/peis.hpp"
#include "proxy/classes/proxy_class.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

namespace rubicon::test {

/// Types 300..319: a temperature on channel 1 and a switch on channel 2.
[[nodiscard]] inline proxy::proxy_class sample_class() {
  proxy::proxy_class x;
  x.name = "heater";
  x.types = {{300, 319}};
  x.properties = {{"description", "a heater"}};
  proxy::field temperature;
  temperature.name = "temperature";
  temperature.channel = 1;
  temperature.scale = 0.1;
  temperature.unit = "C";
  x.fields = {temperature};
  x.inputs = {{"switch", 2, {{"on", {0x01}}, {"off", {0x00}}}}};
  return x;
}

/// The newest text that was set under a key; `nothing` if there is none.
[[nodiscard]] inline std::string tuple_at(const fake<peis_peer_actor>& peer, std::string_view key) {
  std::string text = "nothing";
  for (const auto& x : peer.all<set_tuple>()) {
    if (x.key == key)
      text = to_string(x.value.view());
  }
  return text;
}

/// The newest watch on a key. Fails if there is none.
[[nodiscard]] inline watch_tuples watch_on(const fake<peis_peer_actor>& peer,
                                           std::string_view key) {
  watch_tuples found;
  for (const auto& x : peer.all<watch_tuples>()) {
    if (x.key == key)
      found = x;
  }
  REQUIRE(found.client);
  return found;
}

/// Tells the newest watcher of a key that its tuple is `value` now.
inline void set_watched(fixture& world, const fake<peis_peer_actor>& peer, const std::string& key,
                        payload value) {
  const auto watch = watch_on(peer, key);
  world.send(watch.client, tuple_event{watch.watch, watch.owner, key, std::move(value), false});
}

[[nodiscard]] inline payload text_value(std::string_view x) {
  return to_bytes(x);
}

} // namespace rubicon::test
