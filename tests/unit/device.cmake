rubicon_unit_test(unit.device SOURCES
  unit/device_actuator_test.cpp unit/device_trace_test.cpp unit/device_transducer_test.cpp unit/device_walk_test.cpp
  NEEDS rubicon_device rubicon_mote)
rubicon_fuzz(device_trace SOURCE fuzz/device_trace.cpp NEEDS rubicon_device rubicon_radio)
