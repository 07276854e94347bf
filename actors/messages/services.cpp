#include "actors/messages/services.hpp"

#include "scheduler/messages/define_messages.hpp"

namespace rubicon::scheduler {

template void define_messages<init_interface>();
template void define_messages<gateway_interface>();
template void define_messages<forwarder_server_interface>();
template void define_messages<proxy_interface>();
template void define_messages<proxy_manager_interface>();
template void define_messages<peer_app_interface>();
template void define_messages<timed_peer_app_interface>();
template void define_messages<component_interface>();
template void define_messages<pc_interface>();

} // namespace rubicon::scheduler
