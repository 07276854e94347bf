rubicon_test(unit.synaptic SOURCES unit/synaptic_clock_test.cpp NEEDS rubicon_synaptic)
