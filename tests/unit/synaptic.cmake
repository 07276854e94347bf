rubicon_unit_test(unit.synaptic SOURCES unit/synaptic_clock_test.cpp unit/synaptic_message_test.cpp
             unit/synaptic_arrivals_test.cpp unit/synaptic_channels_test.cpp
             unit/synaptic_setup_test.cpp
  EVERYWHERE unit/synaptic_random_test.cpp
  NEEDS rubicon_synaptic)
rubicon_fuzz(synaptic_message SOURCE fuzz/synaptic_message.cpp NEEDS rubicon_synaptic)
