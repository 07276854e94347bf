rubicon_unit_test(unit.bridge SOURCES unit/bridge/discovery_test.cpp unit/bridge/mqtt_bridge_test.cpp unit/bridge/object_table_test.cpp unit/bridge/real_broker_test.cpp unit/bridge/simulated_component_test.cpp unit/bridge/payload_test.cpp unit/bridge/real_rosbridge_test.cpp unit/bridge/ros2_bridge_test.cpp unit/bridge/ros2_message_test.cpp unit/bridge/ros2_services_test.cpp unit/bridge/tls_rosbridge_test.cpp unit/bridge/waiting_messages_test.cpp
  EVERYWHERE unit/bridge/mqtt_random_test.cpp unit/bridge/ros2_load_test.cpp
  NEEDS rubicon_bridge rubicon_io nlohmann_json::nlohmann_json OpenSSL::Crypto OpenSSL::SSL)
rubicon_fuzz(rosbridge_message SOURCE fuzz/bridge/rosbridge_message.cpp NEEDS rubicon_bridge)
