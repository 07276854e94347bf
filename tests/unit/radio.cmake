rubicon_unit_test(unit.radio SOURCES
  unit/radio_access_test.cpp unit/radio_channel_test.cpp unit/radio_contention_test.cpp unit/radio_energy_test.cpp
  unit/radio_frame_test.cpp unit/radio_links_test.cpp unit/radio_listening_test.cpp unit/radio_mac_rules_test.cpp
  unit/radio_mac_test.cpp unit/radio_medium_test.cpp
  unit/radio_noise_test.cpp unit/radio_power_test.cpp unit/radio_random_test.cpp
  unit/radio_receiver_test.cpp unit/radio_reception_test.cpp unit/radio_signal_power_test.cpp
  unit/radio_sinr_test.cpp unit/radio_interferer_test.cpp unit/radio_noise_source_test.cpp
  unit/radio_topology_test.cpp unit/radio_tossim_files_test.cpp
  NEEDS rubicon_radio)
rubicon_fuzz(radio_frame SOURCE fuzz/radio_frame.cpp NEEDS rubicon_radio)
rubicon_fuzz(tossim_noise SOURCE fuzz/tossim_noise.cpp NEEDS rubicon_radio)
rubicon_fuzz(tossim_topology SOURCE fuzz/tossim_topology.cpp NEEDS rubicon_radio)
