#include "exports/stations.hpp"

#include <algorithm>

namespace rubicon::exports {

std::string station_of(const explain::names& known, std::string_view path) {
  if (const auto mote = known.address_of(path))
    return known.of(*mote);
  if (const auto peer = known.peer_of(path))
    return known.of(*peer);
  const auto owner = path.substr(std::min(path.find('/'), path.size() - 1) + 1);
  const auto first = owner.find('/');
  if (known.peer_of(explain::names::kernel_path(std::string(owner.substr(0, first)))))
    return std::string(owner.substr(0, first));
  if (first != std::string_view::npos) { // mote_app/kitchen/fan/sampler-1
    const auto mote = owner.substr(0, owner.find('/', first + 1));
    if (const auto found = known.address_of("mote/" + std::string(mote)))
      return known.of(*found);
    if (const auto sink = owner.substr(0, first); mote.substr(first + 1) == "sink")
      return std::string(sink) + "/sink";
  }
  const auto name = explain::names::of(path);
  return name.empty() ? "ecology" : name;
}

std::string station_of(const explain::traces& all, const explain::node& x) {
  const bool is_of_source = x.what == explain::step::sends || x.what == explain::step::learns;
  if (is_of_source && !x.about.is_tuple)
    return all.known.of(all.messages[x.about.index].source);
  return station_of(all.known, x.from);
}

} // namespace rubicon::exports
