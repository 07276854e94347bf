rubicon_unit_test(unit.parallel SOURCES
  unit/parallel/horizons_test.cpp unit/parallel/queue_test.cpp unit/parallel/workers_test.cpp
  NEEDS rubicon_parallel)
