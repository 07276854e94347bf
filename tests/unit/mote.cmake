rubicon_unit_test(unit.mote SOURCES
  unit/mote_codec_test.cpp unit/mote_crystal_test.cpp unit/mote_duty_test.cpp unit/mote_gateway_lines_test.cpp
  unit/mote_join_test.cpp unit/mote_node_test.cpp unit/mote_nonvolatile_test.cpp unit/mote_registrar_test.cpp unit/mote_sink_test.cpp unit/mote_slots_test.cpp
  EVERYWHERE unit/mote_island_test.cpp
  NEEDS rubicon_mote)
rubicon_fuzz(mote_management SOURCE fuzz/mote_management.cpp NEEDS rubicon_mote)
rubicon_fuzz(mote_descriptor SOURCE fuzz/mote_descriptor.cpp NEEDS rubicon_mote)
