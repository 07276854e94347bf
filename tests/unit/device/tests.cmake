rubicon_unit_test(unit.device SOURCES
  unit/device/actuator_test.cpp unit/device/trace_test.cpp unit/device/transducer_test.cpp unit/device/walk_test.cpp
  NEEDS rubicon_device rubicon_mote)
rubicon_fuzz(device_trace SOURCE fuzz/files/device_trace.cpp NEEDS rubicon_device rubicon_radio)
