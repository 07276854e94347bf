rubicon_unit_test(unit.gateway SOURCES unit/gateway/gateway_test.cpp unit/gateway/directory_test.cpp unit/gateway/knowledge_test.cpp unit/gateway/lead_test.cpp
             unit/gateway/outputs_test.cpp unit/gateway/parts_test.cpp unit/gateway/plain_test.cpp unit/gateway/strict_test.cpp NEEDS rubicon_gateway
  DEFINE RUBICON_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
rubicon_fuzz(gateway_relay SOURCE fuzz/gateway_relay.cpp NEEDS rubicon_gateway)
