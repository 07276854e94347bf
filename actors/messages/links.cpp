#include "actors/messages/links.hpp"

#include "scheduler/messages/define_messages.hpp"

namespace rubicon::scheduler {

template void define_messages<link_end_interface>();
template void define_messages<lan_user_interface>();
template void define_messages<peis_lan_interface>();
template void define_messages<hello_sender_interface>();
template void define_messages<bluetooth_user_interface>();
template void define_messages<peis_bluetooth_interface>();

} // namespace rubicon::scheduler
