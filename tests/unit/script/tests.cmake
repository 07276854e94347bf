rubicon_unit_test(unit.script SOURCES unit/script/program_test.cpp unit/script/sandbox_test.cpp NEEDS rubicon_script)
