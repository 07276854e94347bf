rubicon_unit_test(unit.report SOURCES
  unit/report/merge_test.cpp unit/report/metrics_test.cpp unit/report/run_counters_test.cpp unit/report/expectations_test.cpp
  unit/report/fault_plan_test.cpp unit/report/figures_test.cpp unit/report/history_test.cpp unit/report/invariants_test.cpp unit/report/layout_test.cpp
  unit/report/report_test.cpp unit/report/time_watch_test.cpp unit/report/sample.cpp
  NEEDS rubicon_report
  DEFINE RUBICON_REPORT_DOCUMENT="${PROJECT_SOURCE_DIR}/docs/report.md")
