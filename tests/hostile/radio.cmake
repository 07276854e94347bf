# What comes from outside by radio and by cable: cores in virtual time, without actors.
rubicon_test(hostile.air SOURCES hostile/air_test.cpp NEEDS rubicon_mote)
rubicon_test(hostile.serial SOURCES hostile/serial_test.cpp NEEDS rubicon_gateway rubicon_mote rubicon_serial)
