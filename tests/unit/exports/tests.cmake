rubicon_unit_test(unit.exports SOURCES unit/exports/exports_test.cpp
  NEEDS rubicon_exports nlohmann_json::nlohmann_json)
