rubicon_unit_test(unit.proxy SOURCES
  unit/proxy/class_table_test.cpp unit/proxy/tuple_key_test.cpp unit/proxy/layout_test.cpp
  unit/proxy/input_channel_test.cpp unit/proxy/proxy_test.cpp unit/proxy/manager_test.cpp
  unit/proxy/gateway_choice_test.cpp
  unit/proxy/rules_test.cpp unit/proxy/object_test.cpp unit/proxy/template_test.cpp unit/proxy/program_test.cpp unit/proxy/quality_test.cpp unit/proxy/type_range_test.cpp
  NEEDS rubicon_proxy)
rubicon_fuzz(proxy_devices_text SOURCE fuzz/proxy_devices_text.cpp NEEDS rubicon_proxy)
rubicon_fuzz(proxy_layout SOURCE fuzz/proxy_layout.cpp NEEDS rubicon_proxy)
