rubicon_unit_test(unit.traffic SOURCES
  unit/traffic/line_test.cpp unit/traffic/packet_test.cpp unit/traffic/part_test.cpp
  unit/traffic/program_test.cpp unit/traffic/schedule_test.cpp
  NEEDS rubicon_traffic)
rubicon_fuzz(traffic_packet SOURCE fuzz/traffic_packet.cpp NEEDS rubicon_traffic)
