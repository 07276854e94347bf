#include "actors/messages/programs.hpp"

#include "scheduler/messages/define_messages.hpp"

namespace rubicon::scheduler {

template void define_messages<program_client_interface>();
template void define_messages<program_node_interface>();
template void define_messages<mote_interface>();
template void define_messages<program_interface>();
template void define_messages<sink_interface>();

} // namespace rubicon::scheduler
