#include "proxy/rules/rules_component.hpp"

#include <algorithm>
#include <array>

namespace rubicon::proxy {

namespace {

/// Number of the watch on what is read. Watch n + 1 is on the n-th tuple that rules write.
constexpr std::uint64_t watch_read = 0;

/// What a kernel says of a write that will never be taken, however often it is tried
/// (peis::to_string).
constexpr std::array<std::string_view, 7> refusals{
    "bad_key", "bad_value", "too_long", "abstract", "bad_meta_tuple", "space_full", "refused"};

write_end end_of(std::string_view cause) {
  if (cause.empty())
    return write_end::accepted;
  return std::ranges::find(refusals, cause) != refusals.end() ? write_end::refused
                                                              : write_end::unreached;
}

} // namespace

components::outputs rules_component::start(instant now) {
  rules_.start(now, away_since_);
  components::outputs out;
  for (const auto& key : rules_.watched())
    out.emplace_back(components::watch{watch_read, any_peer, key});
  std::uint64_t watch = watch_read;
  for (const auto& key : rules_.written())
    out.emplace_back(components::watch{++watch, any_peer, key});
  for (auto& x : on_time(now)) // what is late
    out.push_back(std::move(x));
  return out;
}

components::outputs rules_component::on_tuple(const components::news& x, instant now) {
  if (x.deleted) {
    on_gone(x, now);
    return outputs_of({}, now);
  }
  if (x.watch == watch_read)
    return outputs_of(rules_.on_value(x.key, x.text, now), now);
  const auto& key = rules_.written().at(x.watch - 1);
  const auto [known, is_new] = owners_.try_emplace(key, owner{x.owner});
  auto& of = known->second;
  const bool is_same = !is_new && of.id == x.owner;
  if (is_same && of.is_there)
    return {};
  of.id = x.owner;
  of.is_there = true;
  return outputs_of(rules_.on_owner(key, now, is_same), now);
}

components::outputs rules_component::on_written(std::uint64_t token, std::string_view cause,
                                                instant now) {
  for (const auto& [key, of] : owners_)
    if (of.asked == token)
      rules_.on_written(key, end_of(cause), cause, now);
  return outputs_of({}, now);
}

components::outputs rules_component::on_time(instant now) {
  return outputs_of(rules_.on_time(now), now);
}

components::figures rules_component::figures() const {
  components::figures out;
  const auto add_all = [&out](const std::string& whose, const write_counters& x) {
    components::add_figures<rubicon::proxy::write_counters>(out, x, whose);
    const auto ended = x.accepted + x.refused + x.replaced + x.lost;
    out.emplace_back(whose + "waiting", static_cast<double>(x.writes - ended));
  };
  const auto& each = rules_.counters_of_rules();
  write_counters sum;
  for (const auto& x : each)
    sum += x;
  add_all("", sum);
  components::add_figures<rubicon::proxy::rules_counters>(out, rules_.counters());
  const auto of_all = out.size();
  for (std::size_t i = 0; each.size() > 1 && i < each.size(); ++i)
    add_all("rule " + std::to_string(i + 1) + ' ', each[i]);
  const auto is_zero = [](const auto& x) { return x.second == 0; };
  out.erase(std::remove_if(out.begin() + static_cast<std::ptrdiff_t>(of_all), out.end(), is_zero),
            out.end());
  return out;
}

/// The owner may be back: then what has not got to it is written again.
void rules_component::on_gone(const components::news& x, instant now) {
  if (x.watch == watch_read) {
    rules_.on_gone(x.key);
    return;
  }
  const auto& key = rules_.written().at(x.watch - 1);
  const auto known = owners_.find(key);
  if (known == owners_.end() || known->second.id != x.owner)
    return;
  known->second.is_there = false;
  rules_.on_owner_gone(key, now);
}

components::outputs rules_component::outputs_of(const std::vector<write_tuple>& writes,
                                                instant now) {
  components::outputs out;
  for (const auto& x : writes) {
    const auto known = owners_.find(x.key);
    if (known == owners_.end() || !known->second.is_there) {
      rules_.on_unowned(x.key, now); // said again when the owner is found: rules::on_owner
      continue;
    }
    auto& of = known->second;
    of.asked = ++tokens_;
    out.emplace_back(
        components::tell{"writes " + x.key + " = " + x.word + (x.again ? " again" : "")});
    out.emplace_back(components::write{of.id, x.key, x.word, x.meta, of.asked});
  }
  for (auto& what : rules_.take_notices())
    out.emplace_back(components::tell{std::move(what)});
  return out;
}

} // namespace rubicon::proxy
