rubicon_test(unit.runtime SOURCES
  unit/runtime_run_counters_test.cpp unit/runtime_expectations_test.cpp
  unit/runtime_fault_plan_test.cpp unit/runtime_figures_test.cpp unit/runtime_invariants_test.cpp unit/runtime_layout_test.cpp
  unit/runtime_report_test.cpp unit/runtime_sample.cpp
  NEEDS rubicon_runtime)
target_compile_definitions(test_unit.runtime PRIVATE
  RUBICON_REPORT_DOCUMENT="${PROJECT_SOURCE_DIR}/docs/report.md")
