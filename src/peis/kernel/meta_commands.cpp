#include "peis/kernel/meta_commands.hpp"

#include <utility>

#include "peis/kernel/kernel_turn.hpp"

namespace rubicon::peis {

outputs meta_commands::declare(std::string_view name, instant now, request_id request) {
  if (is_meta_tuple(layers_.self(), name) && !layers_.network.view().own.left) {
    kernel_turn turn(layers_, now);
    turn.report(request, cause::none);
    return turn.finish();
  }
  return tuples_.set(name, meta_content({}), now, request);
}

outputs meta_commands::set_reference(peer_id meta_owner, std::string_view meta_key,
                                     peer_id target_owner, std::string_view target_key,
                                     request_id request, instant now) {
  const auto target = key::parse(target_key);
  auto why = layers_.refusal(target);
  if (why == cause::none && (target->is_pattern() || target_owner.value <= 0))
    why = cause::abstract;
  if (why != cause::none) {
    kernel_turn turn(layers_, now);
    turn.report(request, why);
    return turn.finish();
  }
  return tuples_.set_remote(meta_owner, meta_key, meta_content(meta_target{target_owner, *target}),
                            request, now);
}

bool meta_commands::is_meta_tuple(peer_id owner, std::string_view name) const {
  const auto x = reader_.find(owner, name);
  return x && read_meta(*x);
}

/// What a meta tuple that we hold points at; bad_value if we hold none.
result<meta_reference> meta_commands::look_up(peer_id meta_owner, std::string_view meta_key,
                                              instant now) {
  const auto meta = reader_.get(meta_owner, meta_key, read_mode::keep_old, now);
  return meta ? read_meta(*meta.content) : errc::bad_value;
}

reading meta_commands::get_indirectly(peer_id meta_owner, std::string_view meta_key, read_mode mode,
                                      instant now) {
  const auto target = look_up(meta_owner, meta_key, now);
  if (!target)
    return {nullptr, false, cause::bad_meta_tuple};
  if (!*target)
    return {};
  return reader_.get(prototype_of((*target)->owner, (*target)->name), mode, now);
}

outputs meta_commands::set_indirectly(peer_id meta_owner, std::string_view meta_key,
                                      tuple_content content, request_id request, instant now) {
  const auto target = look_up(meta_owner, meta_key, now);
  if (!target || !*target) {
    kernel_turn turn(layers_, now);
    turn.refuse(request, cause::bad_meta_tuple);
    return turn.finish();
  }
  return tuples_.set_remote((*target)->owner, (*target)->name.text(), std::move(content), request,
                            now);
}

} // namespace rubicon::peis
