rubicon_unit_test(unit.report SOURCES
  unit/report_merge_test.cpp unit/report_run_counters_test.cpp unit/report_expectations_test.cpp
  unit/report_fault_plan_test.cpp unit/report_figures_test.cpp unit/report_history_test.cpp unit/report_invariants_test.cpp unit/report_layout_test.cpp
  unit/report_report_test.cpp unit/report_time_watch_test.cpp unit/report_sample.cpp
  NEEDS rubicon_report
  DEFINE RUBICON_REPORT_DOCUMENT="${PROJECT_SOURCE_DIR}/docs/report.md")
