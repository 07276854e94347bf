rubicon_unit_test(unit.imports SOURCES unit/imports/imports_test.cpp
  NEEDS rubicon_imports)
rubicon_fuzz(imports SOURCE fuzz/files/imports.cpp NEEDS rubicon_imports)
