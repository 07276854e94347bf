rubicon_unit_test(unit.radio SOURCES
  unit/radio/access_test.cpp unit/radio/channel/battery_watch_test.cpp unit/radio/channel/disturbances_test.cpp
  unit/radio/channel/event_queue_test.cpp unit/radio/channel_test.cpp unit/radio/contention_test.cpp unit/radio/energy_test.cpp
  unit/radio/frame_test.cpp unit/radio/links_test.cpp unit/radio/listening_test.cpp unit/radio/medium/lone_frame_test.cpp unit/radio/mac_rules_test.cpp
  unit/radio/mac_test.cpp unit/radio/medium_test.cpp
  unit/radio/noise_test.cpp unit/radio/power_test.cpp unit/radio/random_test.cpp unit/radio/raw_frame_test.cpp
  unit/radio/receiver_test.cpp unit/radio/reception_test.cpp unit/radio/signal_power_test.cpp
  unit/radio/sinr_test.cpp unit/radio/interferer_test.cpp unit/radio/noise_source_test.cpp
  unit/radio/topology_test.cpp unit/radio/tossim_files_test.cpp
  NEEDS rubicon_radio)
rubicon_fuzz(radio_frame SOURCE fuzz/radio_frame.cpp NEEDS rubicon_radio)
rubicon_fuzz(tossim_noise SOURCE fuzz/files/tossim_noise.cpp NEEDS rubicon_radio)
rubicon_fuzz(tossim_topology SOURCE fuzz/files/tossim_topology.cpp NEEDS rubicon_radio)
