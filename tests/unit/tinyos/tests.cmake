rubicon_unit_test(unit.tinyos SOURCES
  unit/tinyos/base_station_test.cpp unit/tinyos/program_test.cpp
  NEEDS rubicon_tinyos)
