rubicon_unit_test(unit.page SOURCES
  unit/page_markup_test.cpp unit/page_run_page_test.cpp unit/page_swarm_page_test.cpp unit/report_sample.cpp
  NEEDS rubicon_page)
