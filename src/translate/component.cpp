#include "translate/component.hpp"

namespace rubicon::translate {

components::outputs component::start(instant) {
  components::outputs out;
  for (const auto& key : core_.watched())
    out.emplace_back(components::watch{0, any_peer, key});
  return out;
}

components::outputs component::on_tuple(const components::news& x, instant now) {
  const bool own = x.owner == self_;
  components::outputs out;
  for (auto& each :
       x.deleted ? core_.on_gone(x.key, own) : core_.on_value(x.key, x.text, own, now)) {
    if (const auto* published = std::get_if<publish>(&each))
      out.emplace_back(
          components::publish{published->key, to_bytes(std::string_view(published->text))});
    else
      out.emplace_back(components::erase{std::get<erase>(each).key});
  }
  return out;
}

components::figures component::figures() const {
  const auto& counted = core_.counters();
  const auto figure = [](std::uint64_t x) { return static_cast<double>(x); };
  return {{"translated", figure(counted.translated)}, {"tuples", figure(core_.targets())},
          {"bad values", figure(counted.bad_values)}, {"long values", figure(counted.long_values)},
          {"bad keys", figure(counted.bad_keys)},     {"refused", figure(counted.refused)},
          {"own tuples", figure(counted.own)}};
}

} // namespace rubicon::translate
