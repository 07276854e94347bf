rubicon_unit_test(unit.peer SOURCES unit/peer/bluetooth_test.cpp unit/peer/callback_table_test.cpp unit/peer/standalone_test.cpp unit/peer/wire_test.cpp unit/peer/udp_test.cpp NEEDS rubicon_peer)
