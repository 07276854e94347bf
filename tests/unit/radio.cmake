rubicon_test(unit.radio SOURCES
  unit/radio_channel_test.cpp unit/radio_contention_test.cpp unit/radio_energy_test.cpp
  unit/radio_frame_test.cpp unit/radio_mac_test.cpp unit/radio_medium_test.cpp
  unit/radio_power_test.cpp unit/radio_random_test.cpp unit/radio_receiver_test.cpp
  unit/radio_topology_test.cpp
  NEEDS rubicon_radio)
rubicon_fuzz(radio_frame SOURCE fuzz/radio_frame.cpp NEEDS rubicon_radio)
# A measurement, not a test.
add_executable(bench_radio bench/radio_bench.cpp)
target_link_libraries(bench_radio PRIVATE rubicon_radio)
