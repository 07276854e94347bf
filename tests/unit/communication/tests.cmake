rubicon_unit_test(unit.communication SOURCES
  unit/communication/gateway_test.cpp unit/communication/mockup_test.cpp
  unit/communication/pc_test.cpp
  unit/communication/remote_test.cpp unit/communication/streams_test.cpp unit/communication/communication_test.cpp
  EVERYWHERE unit/communication/stream_test.cpp unit/communication/synaptic_test.cpp unit/communication/connectionless_test.cpp
  NEEDS rubicon_communication rubicon_gateway rubicon_mote)
