rubicon_unit_test(unit.imports SOURCES unit/imports/imports_test.cpp
  NEEDS rubicon_imports)
