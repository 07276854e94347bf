rubicon_unit_test(unit.tinyos SOURCES
  unit/tinyos_base_station_test.cpp unit/tinyos_program_test.cpp
  NEEDS rubicon_tinyos)
