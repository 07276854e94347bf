rubicon_unit_test(unit.study SOURCES
  unit/study/grid_test.cpp unit/study/statistics_test.cpp unit/study/store_test.cpp
  NEEDS rubicon_study)
