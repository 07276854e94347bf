rubicon_unit_test(unit.page SOURCES
  unit/page/markup_test.cpp unit/page/run_page_test.cpp unit/page/study_page_test.cpp unit/page/swarm_page_test.cpp unit/report/sample.cpp
  NEEDS rubicon_page)
