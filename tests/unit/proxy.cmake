rubicon_unit_test(unit.proxy SOURCES
  unit/proxy_class_table_test.cpp unit/proxy_tuple_key_test.cpp unit/proxy_layout_test.cpp
  unit/proxy_input_channel_test.cpp unit/proxy_proxy_test.cpp unit/proxy_manager_test.cpp
  unit/proxy_gateway_choice_test.cpp
  unit/proxy_rules_test.cpp unit/proxy_object_test.cpp unit/proxy_template_test.cpp unit/proxy_program_test.cpp unit/proxy_quality_test.cpp unit/proxy_type_range_test.cpp
  NEEDS rubicon_proxy)
rubicon_fuzz(proxy_devices_text SOURCE fuzz/proxy_devices_text.cpp NEEDS rubicon_proxy)
rubicon_fuzz(proxy_layout SOURCE fuzz/proxy_layout.cpp NEEDS rubicon_proxy)
