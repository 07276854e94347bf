rubicon_unit_test(unit.apps SOURCES unit/apps_operators_test.cpp unit/apps_reports_test.cpp NEEDS rubicon_apps rubicon_mote)
