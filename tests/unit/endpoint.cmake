rubicon_test(unit.endpoint SOURCES
  unit/endpoint_connectionless_test.cpp unit/endpoint_pc_test.cpp unit/endpoint_stream_test.cpp
  unit/endpoint_synaptic_test.cpp unit/endpoint_gateway_test.cpp
  NEEDS rubicon_endpoint rubicon_gateway)
rubicon_test(unit.mockup SOURCES unit/mockup_test.cpp NEEDS rubicon_endpoint)
