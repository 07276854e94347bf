# What comes from outside by radio and by cable: cores in virtual time, without actors.
if(TARGET rubicon_gateway) # a build of a few rooms may lack it
  rubicon_unit_test(hostile.air EVERYWHERE hostile/air_test.cpp NEEDS rubicon_mote)
  rubicon_unit_test(hostile.serial EVERYWHERE hostile/serial_test.cpp NEEDS rubicon_gateway rubicon_mote rubicon_serial)
endif()
