rubicon_unit_test(unit.serial SOURCES
  unit/serial_backbone_test.cpp unit/serial_fixture.cpp unit/serial_frame_test.cpp unit/serial_packet_test.cpp
  unit/serial_mote_port_test.cpp unit/serial_host_port_test.cpp unit/serial_line_test.cpp
  unit/serial_joined_test.cpp unit/serial_forwarder_test.cpp unit/serial_noise_test.cpp
  unit/serial_raw_packet_test.cpp unit/serial_meaning_test.cpp unit/serial_recording_test.cpp
  NEEDS rubicon_serial)
foreach(target serial_frame serial_mote_port serial_am_packet serial_raw_packet serial_forwarder serial_recording)
  rubicon_fuzz(${target} SOURCE fuzz/${target}.cpp NEEDS rubicon_serial)
endforeach()
