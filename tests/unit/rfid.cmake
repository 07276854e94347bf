rubicon_unit_test(unit.rfid SOURCES unit/rfid_reader_test.cpp NEEDS rubicon_rfid)
