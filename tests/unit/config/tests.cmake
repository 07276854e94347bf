rubicon_unit_test(unit.config SOURCES
  unit/config/units_test.cpp unit/config/file_test.cpp unit/config/label_test.cpp
  unit/config/values_test.cpp unit/config/problems_test.cpp unit/config/key_list_test.cpp unit/config/references_test.cpp
  unit/config/description_test.cpp unit/config/examples_test.cpp unit/config/summary_test.cpp
  unit/config/docs_test.cpp unit/config/island/access_test.cpp unit/config/island/radio_test.cpp unit/config/island/group_test.cpp
  unit/config/island/flow_test.cpp unit/config/peer/peer_test.cpp unit/config/island/placement_test.cpp unit/config/peer/component_test.cpp unit/config/peer/bluetooth_test.cpp unit/config/change_test.cpp unit/config/reload_test.cpp unit/config/settings_test.cpp unit/config/fault_test.cpp unit/config/variation_test.cpp unit/config/expectation_test.cpp unit/config/warnings_test.cpp unit/config/alias_test.cpp unit/config/island/outside_test.cpp unit/config/island/application_test.cpp unit/config/island/lua_test.cpp unit/config/island/firmware_test.cpp unit/config/island/transducer_test.cpp unit/config/island/connectivity_test.cpp unit/config/island/slots_test.cpp unit/config/island/listening_test.cpp unit/config/island/sinks_test.cpp unit/config/peer/tag_test.cpp unit/config/peer/goal_test.cpp unit/config/peer/mqtt_test.cpp unit/config/peer/ros2_test.cpp unit/config/peer/proxy_test.cpp unit/config/quantity_test.cpp unit/config/sample.cpp
  NEEDS rubicon_config
  DEFINE RUBICON_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
rubicon_fuzz(config_toml SOURCE fuzz/files/config_toml.cpp NEEDS rubicon_config)
