#include "actors/messages/backbone.hpp"

#include "scheduler/messages/define_messages.hpp"

namespace rubicon::scheduler {

template void define_messages<backbone_end_interface>();
template void define_messages<backbone_interface>();

} // namespace rubicon::scheduler
