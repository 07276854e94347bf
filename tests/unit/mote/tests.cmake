rubicon_unit_test(unit.mote SOURCES
  unit/mote/codec_test.cpp unit/mote/crystal_test.cpp unit/mote/duty_test.cpp unit/mote/gateway_lines_test.cpp
  unit/mote/join_test.cpp unit/mote/node_test.cpp unit/mote/nonvolatile_test.cpp unit/mote/registrar_test.cpp unit/mote/sink_test.cpp unit/mote/slots_test.cpp unit/mote/stack_test.cpp
  EVERYWHERE unit/mote/island_test.cpp
  NEEDS rubicon_mote)
rubicon_fuzz(mote_management SOURCE fuzz/mote_management.cpp NEEDS rubicon_mote)
rubicon_fuzz(mote_descriptor SOURCE fuzz/mote_descriptor.cpp NEEDS rubicon_mote)
