rubicon_unit_test(unit.bridge SOURCES unit/bridge/discovery_test.cpp unit/bridge/mqtt_bridge_test.cpp unit/bridge/object_table_test.cpp unit/bridge/real_broker_test.cpp unit/bridge/simulated_component_test.cpp
  EVERYWHERE unit/bridge/mqtt_random_test.cpp
  NEEDS rubicon_bridge rubicon_io nlohmann_json::nlohmann_json)
