#include "scheduler/define_messages.hpp"
#include "unit/scheduler_support.hpp"

template void rubicon::scheduler::define_messages<scheduler_test::any_interface>();
