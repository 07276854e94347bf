#include "scheduler/messages/define_messages.hpp"
#include "unit/scheduler/support.hpp"

template void rubicon::scheduler::define_messages<scheduler_test::any_interface>();
