rubicon_unit_test(unit.study SOURCES
  unit/study/comparison_test.cpp unit/study/grid_test.cpp unit/study/series_test.cpp unit/study/shrink_test.cpp unit/study/statistics_test.cpp unit/study/stopping_test.cpp
  unit/study/store_test.cpp unit/study/turning_point_test.cpp
  NEEDS rubicon_study)
