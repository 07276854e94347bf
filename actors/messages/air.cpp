#include "actors/messages/air.hpp"

#include "scheduler/messages/define_messages.hpp"

namespace rubicon::scheduler {

template void define_messages<radio_user_interface>();
template void define_messages<air_interface>();

} // namespace rubicon::scheduler
