rubicon_test(unit.gateway SOURCES unit/gateway_test.cpp NEEDS rubicon_gateway)
