#include "actors/messages/peis.hpp"

#include "scheduler/messages/define_messages.hpp"

namespace rubicon::scheduler {

template void define_messages<peis_client_interface>();
template void define_messages<subscribers_watcher_interface>();
template void define_messages<clock_watcher_interface>();
template void define_messages<peis_peer_interface>();

} // namespace rubicon::scheduler
