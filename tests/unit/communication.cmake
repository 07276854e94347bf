rubicon_unit_test(unit.communication SOURCES
  unit/communication_gateway_test.cpp unit/communication_mockup_test.cpp
  unit/communication_pc_test.cpp
  unit/communication_remote_test.cpp unit/communication_streams_test.cpp unit/communication_test.cpp
  EVERYWHERE unit/communication_stream_test.cpp unit/communication_synaptic_test.cpp unit/communication_connectionless_test.cpp
  NEEDS rubicon_communication rubicon_gateway rubicon_mote)
