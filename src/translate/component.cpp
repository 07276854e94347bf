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
  components::figures out;
  components::add_figures<translate::translator_counters>(out, core_.counters());
  out.insert(out.begin() + 1, {"tuples", static_cast<double>(core_.targets())});
  return out;
}

} // namespace rubicon::translate
