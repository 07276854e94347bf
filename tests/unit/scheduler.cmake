rubicon_test(unit.scheduler SOURCES
  unit/scheduler_clock_test.cpp unit/scheduler_envelope_test.cpp unit/scheduler_messages.cpp
  unit/scheduler_order_test.cpp unit/scheduler_processes_test.cpp unit/scheduler_run_test.cpp
  unit/scheduler_shutdown_test.cpp unit/scheduler_supervision_test.cpp
  unit/scheduler_trace_test.cpp unit/scheduler_wall_test.cpp
  NEEDS rubicon_scheduler
  PRECOMPILE <scheduler/world.hpp> <support/catch.hpp>
  BATCH 8)
