rubicon_test(unit.flow SOURCES
  unit/flow_line_test.cpp unit/flow_packet_test.cpp unit/flow_part_test.cpp
  unit/flow_program_test.cpp unit/flow_schedule_test.cpp
  NEEDS rubicon_flow)
rubicon_fuzz(flow_packet SOURCE fuzz/flow_packet.cpp NEEDS rubicon_flow)
