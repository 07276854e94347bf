rubicon_unit_test(unit.parallel SOURCES
  unit/parallel_horizons_test.cpp unit/parallel_queue_test.cpp unit/parallel_workers_test.cpp
  NEEDS rubicon_parallel)
