rubicon_unit_test(unit.config SOURCES
  unit/config_units_test.cpp unit/config_file_test.cpp
  unit/config_values_test.cpp unit/config_problems_test.cpp unit/config_references_test.cpp
  unit/config_description_test.cpp unit/config_examples_test.cpp unit/config_summary_test.cpp
  unit/config_docs_test.cpp unit/config_access_test.cpp unit/config_radio_test.cpp unit/config_group_test.cpp
  unit/config_flow_test.cpp unit/config_peer_test.cpp unit/config_placement_test.cpp unit/config_component_test.cpp unit/config_bluetooth_test.cpp unit/config_change_test.cpp unit/config_reload_test.cpp unit/config_fault_test.cpp unit/config_expectation_test.cpp unit/config_doubts_test.cpp unit/config_alias_test.cpp unit/config_outside_test.cpp unit/config_application_test.cpp unit/config_transducer_test.cpp unit/config_reach_test.cpp unit/config_slots_test.cpp unit/config_listening_test.cpp unit/config_sinks_test.cpp unit/config_tag_test.cpp unit/config_goal_test.cpp unit/config_proxy_test.cpp unit/config_quantity_test.cpp unit/config_sample.cpp
  NEEDS rubicon_config
  DEFINE RUBICON_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
rubicon_fuzz(config_toml SOURCE fuzz/config_toml.cpp NEEDS rubicon_config)
