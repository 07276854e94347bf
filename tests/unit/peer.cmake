rubicon_unit_test(unit.peer SOURCES unit/peer_bluetooth_test.cpp unit/peer_standalone_test.cpp unit/peer_wire_test.cpp unit/peer_udp_test.cpp NEEDS rubicon_peer)
