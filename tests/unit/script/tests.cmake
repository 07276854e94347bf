rubicon_unit_test(unit.script SOURCES
  unit/script/examples_test.cpp unit/script/program_test.cpp unit/script/resources_test.cpp unit/script/sandbox_test.cpp
  NEEDS rubicon_script rubicon_config
  DEFINE RUBICON_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
