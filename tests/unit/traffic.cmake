rubicon_unit_test(unit.traffic SOURCES
  unit/traffic_line_test.cpp unit/traffic_packet_test.cpp unit/traffic_part_test.cpp
  unit/traffic_program_test.cpp unit/traffic_schedule_test.cpp
  NEEDS rubicon_traffic)
rubicon_fuzz(traffic_packet SOURCE fuzz/traffic_packet.cpp NEEDS rubicon_traffic)
