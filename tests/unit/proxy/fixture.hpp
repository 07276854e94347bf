// A proxy of a mote of the class `climate`, and what its tests say of it.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/tuples/device_keys.hpp"
#include "proxy/proxy.hpp"
#include "support/start.hpp"

namespace rubicon::test {

using rubicon::proxy::encoding;
using rubicon::proxy::proxy_class;
using rubicon::proxy::proxy_identity;
using rubicon::proxy::proxy_settings;
using rubicon::proxy::publish;
using rubicon::proxy::retire;
using rubicon::proxy::signature;
using rubicon::proxy::signature_of;
using rubicon::proxy::watch;
using rubicon::proxy::write_device;
using face = rubicon::proxy::proxy;

inline proxy_class claims(std::string name, std::vector<rubicon::proxy::type_range> types) {
  proxy_class x;
  x.name = std::move(name);
  x.types = std::move(types);
  return x;
}

inline proxy_class climate() {
  proxy_class x;
  x.name = "climate";
  x.types = {{100, 199}};
  x.prefix = "{island}.{name}-{id}";
  x.properties = {{"colour", "white"}, {"size.height", "0.1 m"}};
  x.fields = {{"temperature", 1, 0, encoding::i16, 0.1, 0, 1, "C", {}},
              {"humidity", 1, 2, encoding::u8, 1, 0, 0, "%", {}},
              {"state", 2, 0, encoding::u8, 1, 0, 0, "", {{0, "off"}, {1, "on"}}}};
  x.inputs = {{"switch", 2, {{"on", {1}}, {"off", {0}}}}, {"led", 3, {{"red", {1, 2}}}}};
  return x;
}

inline proxy_identity identity() {
  return {{island_id{5}, mote_id{7}}, "kitchen", "climate"};
}

using lines = std::vector<std::string>;

inline lines lines_of(const face::outputs& outputs) {
  struct formatter {
    std::string operator()(const publish& x) const { return x.key + " = " + x.text; }
    std::string operator()(const write_device& x) const {
      return "write " + to_string(x.mote) + ' ' + device_input_key(x.mote.mote, x.channel) + ' ' +
             to_hex(x.octets);
    }
    std::string operator()(const rubicon::proxy::declare& x) const {
      return x.key + " -> " + x.target;
    }
    std::string operator()(const rubicon::proxy::write_period& x) const {
      return "period " + device_output_period_key(x.mote.mote, x.channel) + ' ' +
             std::to_string(x.period / 1ms);
    }
    std::string operator()(retire) const { return "retire"; }
  };
  lines list;
  for (const auto& x : outputs)
    list.push_back(std::visit(formatter{}, x));
  return list;
}

inline face started(proxy_settings settings = {}) {
  auto what = climate();
  what.settings = settings;
  face aut(std::move(what), identity());
  static_cast<void>(aut.start(start));
  return aut;
}

inline const std::string base = "kitchen.climate-7.";

inline lines became(std::string_view status, std::string_view cause = "none",
                    instant since = start) {
  return {base + "status.cause = " + std::string(cause), base + "status.since = " + to_text(since),
          base + "status = " + std::string(status)};
}

inline lines operator+(lines a, const lines& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

} // namespace rubicon::test
