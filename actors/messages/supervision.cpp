#include "actors/messages/supervision.hpp"

#include "scheduler/messages/define_messages.hpp"

namespace rubicon::scheduler {

template void define_messages<ecology_interface>();
template void define_messages<root_interface>();

} // namespace rubicon::scheduler
