// What the parts of a mote's actor share: its clock, its radio, the outputs of its node.
#pragma once

#include "actors/island/mote.hpp"
#include "actors/messages/air.hpp"
#include "core/time.hpp"
#include "mote/node.hpp"

namespace rubicon {

using mote_pointer = scheduler::actor_pointer<mote_state, mote_actor>;

/// Copies are the same mote.
struct mote_shell {
  mote_pointer self;

  [[nodiscard]] mote_state& state() const { return self->state; }
  /// What the mote's own clock shows.
  [[nodiscard]] instant own_time() const;
  void set_radio(const radio_demand& x) const;
  /// @pre the mote has a node
  void perform(mote::node_outputs todo) const;
  void notify_ecology(std::string what) const;
};

} // namespace rubicon
