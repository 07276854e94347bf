rubicon_unit_test(unit.gateway SOURCES unit/gateway_test.cpp unit/gateway_directory_test.cpp unit/gateway_knowledge_test.cpp unit/gateway_lead_test.cpp
             unit/gateway_outputs_test.cpp unit/gateway_plain_test.cpp unit/gateway_strict_test.cpp NEEDS rubicon_gateway
  DEFINE RUBICON_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
rubicon_fuzz(gateway_relay SOURCE fuzz/gateway_relay.cpp NEEDS rubicon_gateway)
