rubicon_unit_test(unit.serial SOURCES
  unit/serial/backbone_test.cpp unit/serial/fixture.cpp unit/serial/frame_test.cpp unit/serial/packet_test.cpp
  unit/serial/mote_port_test.cpp unit/serial/host_port_test.cpp unit/serial/line_test.cpp
  unit/serial/joined_test.cpp unit/serial/forwarder_test.cpp unit/serial/noise_test.cpp
  unit/serial/raw_packet_test.cpp unit/serial/meaning_test.cpp unit/serial/recording_test.cpp
  NEEDS rubicon_serial)
foreach(target serial_frame serial_mote_port serial_am_packet serial_raw_packet serial_forwarder serial_recording)
  rubicon_fuzz(${target} SOURCE fuzz/serial/${target}.cpp NEEDS rubicon_serial)
endforeach()
