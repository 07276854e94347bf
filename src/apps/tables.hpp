// How large a node's tables are for the programs on it: as a mote's firmware is compiled for what
// it is to run.
#pragma once

#include <vector>

#include "apps/app_config.hpp"
#include "mote/layer.hpp"

namespace rubicon::apps {

/// Makes tables larger where the defaults have no room for all streams and synaptic channels of
/// these programs.
void make_room(mote::layer_config& tables, const std::vector<app_config>& programs);

} // namespace rubicon::apps
