// What programs send and receive inside the actor of their node, for who observes the run.
#pragma once

#include <any>

#include "communication/layer.hpp"
#include "explain/record.hpp"

namespace rubicon {

/// @param node path of the node's actor
[[nodiscard]] explain::record record_of(const communication::program_note& x,
                                        const std::string& node);

/// @param node of the actor `self`: a mote::node, communication::pc or gateway::gateway
template <class Self, class Node>
void observe_programs(Self* self, Node& node) {
  node.observe([self](const communication::program_note& x) {
    self->remark_any("program", [&] { return std::any(record_of(x, self->path())); });
  });
}

} // namespace rubicon
