// The app that translates tuples into others and keeps their history (SVC-09).
#pragma once

#include <string>

#include "actors/messages.hpp"
#include "translate/translator.hpp"

namespace rubicon {

/// What a translating actor is made of.
struct translate_arguments {
  translate::translator core;
  std::string who; ///< its peer in the report
  peer_id peer_number;
  peis_peer_actor peer;
  ecology_actor ecology;
};

struct translate_state {
  translate_arguments arguments;
};

peer_app_actor::behavior_type
translate_behavior(scheduler::traced_pointer<translate_state, peer_app_actor> self,
                   translate_arguments arguments);

} // namespace rubicon
