rubicon_unit_test(unit.synaptic SOURCES unit/synaptic/clock_test.cpp unit/synaptic/message_test.cpp
             unit/synaptic/arrivals_test.cpp unit/synaptic/channels_test.cpp
             unit/synaptic/setup_test.cpp
  EVERYWHERE unit/synaptic/random_test.cpp
  NEEDS rubicon_synaptic)
rubicon_fuzz(synaptic_message SOURCE fuzz/synaptic_message.cpp NEEDS rubicon_synaptic)
