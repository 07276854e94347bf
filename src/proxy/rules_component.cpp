#include "proxy/rules_component.hpp"

namespace rubicon::proxy {

namespace {

/// Number of the watch on what is read. Watch n + 1 is on the n-th tuple that rules write.
constexpr std::uint64_t watch_read = 0;

} // namespace

components::outputs rules_component::start(instant now) {
  rules_.start(now);
  components::outputs out;
  for (const auto& key : rules_.watched())
    out.emplace_back(components::watch{watch_read, any_peer, key});
  std::uint64_t watch = watch_read;
  for (const auto& key : rules_.written())
    out.emplace_back(components::watch{++watch, any_peer, key});
  return out;
}

components::outputs rules_component::on_tuple(const components::news& x, instant now) {
  if (x.deleted) {
    on_gone(x);
    return {};
  }
  if (x.watch == watch_read)
    return outputs_of(rules_.on_value(x.key, x.text, now));
  const auto& key = rules_.written().at(x.watch - 1);
  const auto [owner, is_new] = owners_.try_emplace(key, x.owner);
  if (!is_new && owner->second == x.owner)
    return {};
  owner->second = x.owner;
  return outputs_of(rules_.on_owner(key, now));
}

components::outputs rules_component::on_time(instant now) {
  return outputs_of(rules_.on_time(now));
}

/// The owner of a tuple to write may be back: its inputs are where they are by default then, so a
/// reference is written again; a word may be a command, and is not.
void rules_component::on_gone(const components::news& x) {
  if (x.watch == watch_read) {
    rules_.on_gone(x.key);
    return;
  }
  const auto& key = rules_.written().at(x.watch - 1);
  const auto known = owners_.find(key);
  if (rules_.is_meta(key) && known != owners_.end() && known->second == x.owner)
    owners_.erase(known);
}

components::outputs rules_component::outputs_of(const std::vector<write_tuple>& writes) const {
  components::outputs out;
  for (const auto& x : writes) {
    const auto owner = owners_.find(x.key);
    if (owner == owners_.end())
      continue; // said again when the owner is found: rules::on_owner
    out.emplace_back(
        components::tell{"writes " + x.key + " = " + x.word + (x.again ? " again" : "")});
    out.emplace_back(components::write{owner->second, x.key, x.word, x.meta});
  }
  return out;
}

} // namespace rubicon::proxy
