rubicon_unit_test(unit.rfid SOURCES unit/rfid/reader_test.cpp NEEDS rubicon_rfid)
