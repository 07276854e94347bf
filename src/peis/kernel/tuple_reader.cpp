#include "peis/kernel/tuple_reader.hpp"

#include "peis/kernel/kernel_turn.hpp"

namespace rubicon::peis {

reading tuple_reader::get(peer_id owner, std::string_view name, read_mode mode, instant now) {
  const auto parsed = key::parse(name);
  if (!parsed)
    return {nullptr, false, cause::bad_key};
  return get(prototype_of(owner, *parsed), mode, now);
}

reading tuple_reader::get(const prototype& wanted, read_mode mode, instant now) {
  if (wanted.owner == any_peer || wanted.name.is_pattern())
    return {nullptr, false, cause::abstract};
  result_set found;
  get_all(wanted, found, now, mode);
  return found.next() ? found.value() : reading();
}

void tuple_reader::get_all(const prototype& wanted, result_set& into, instant now, read_mode mode) {
  if (wanted.owner == layers_.self() || wanted.owner == any_peer)
    kernel_turn(layers_, now).refresh_statistics(wanted.name);
  layers_.tuples.stored().read(wanted, now, [&](const tuple_pointer& x, bool is_new) {
    const bool taken = is_new || mode == read_mode::keep_old;
    if (taken)
      into.append({x, is_new, cause::none});
    return taken;
  });
}

tuple_pointer tuple_reader::find(peer_id owner, std::string_view name) const {
  const auto parsed = key::parse(name);
  return parsed ? layers_.tuples.stored().content(owner, *parsed) : nullptr;
}

std::vector<tuple_pointer> tuple_reader::find_all(peer_id owner, std::string_view pattern) const {
  const auto parsed = key::parse(pattern);
  return parsed ? layers_.tuples.stored().find_all(prototype_of(owner, *parsed))
                : std::vector<tuple_pointer>();
}

std::vector<tuple_pointer> tuple_reader::own() const {
  return layers_.tuples.stored().find_all(prototype_of(layers_.self(), key()));
}

bool tuple_reader::has_subscriber(std::string_view name) const {
  const auto parsed = key::parse(name);
  return parsed && layers_.tuples.audience().has_subscriber(*parsed);
}

bool tuple_reader::is_waiting(std::string_view name) const {
  const auto parsed = key::parse(name);
  return parsed && layers_.tuples.is_waiting(*parsed);
}

} // namespace rubicon::peis
