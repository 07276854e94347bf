rubicon_unit_test(unit.apps SOURCES unit/apps/operators_test.cpp unit/apps/reports_test.cpp NEEDS rubicon_apps rubicon_mote)
