rubicon_test(unit.scheduler SOURCES
  unit/scheduler/clock_test.cpp unit/scheduler/envelope_test.cpp unit/scheduler/messages.cpp
  unit/scheduler/order_test.cpp unit/scheduler/processes_test.cpp unit/scheduler/run_test.cpp
  unit/scheduler/shutdown_test.cpp unit/scheduler/supervision_test.cpp
  unit/scheduler/trace_test.cpp unit/scheduler/wall_test.cpp
  NEEDS rubicon_scheduler
  PRECOMPILE <scheduler/world.hpp> <support/catch.hpp>
  BATCH 8)
