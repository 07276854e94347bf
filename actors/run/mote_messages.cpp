#include "actors/run/mote_messages.hpp"

#include <utility>

#include "actors/island/mote.hpp"

namespace rubicon {

namespace {

/// Where a mote of that address in the file is now.
const supervised_mote* find_mote(const ecology_state& all, mote_address x) {
  for (auto moved = all.moved.find(x); moved != all.moved.end(); moved = all.moved.find(x))
    x = moved->second.to;
  const auto found = all.motes.find(x);
  return found == all.motes.end() ? nullptr : &found->second;
}

/// nullptr: it does not run, or its end is not known to the ecology yet.
const mote_state* state_of(const supervised_mote* mote) {
  if (mote == nullptr || mote->flat || !mote->handle || mote->handle.get().has_ended())
    return nullptr;
  const auto& state =
      static_cast<const scheduler::shell<mote_state, mote_interface>&>(mote->handle.get()).state;
  return state.flat ? nullptr : &state;
}

} // namespace

std::string send_as(const ecology_state& all, mote_address mote, send_as_program x) {
  const auto* const of = find_mote(all, mote);
  const auto* const state = state_of(of);
  if (state == nullptr)
    return "the mote does not run";
  if (!state->node)
    return "the mote has no programs that send messages";
  if (const auto most = state->arguments->node.tables->layer.messages.payload_max;
      x.octets.view().size() > most)
    return "a message has at most " + std::to_string(most) + " octets";
  if (!state->node->member().joined())
    return "the mote has not joined its island";
  post(of->handle, std::move(x));
  return {};
}

} // namespace rubicon
