rubicon_unit_test(unit.network SOURCES unit/network_packet_test.cpp unit/network_places_test.cpp
             unit/network_event_test.cpp
             unit/network_channels_test.cpp unit/network_collection_test.cpp unit/network_sequence_windows_test.cpp
             unit/network_clock_line_test.cpp unit/network_router_test.cpp unit/network_schedule_test.cpp unit/network_search_test.cpp
             unit/network_turns_test.cpp
  EVERYWHERE unit/network_backbone_test.cpp unit/network_clock_test.cpp unit/network_reference_test.cpp
  NEEDS rubicon_network rubicon_serial)
rubicon_fuzz(island_packet SOURCE fuzz/island_packet.cpp NEEDS rubicon_network)
rubicon_fuzz(sink_event SOURCE fuzz/sink_event.cpp NEEDS rubicon_network)
rubicon_unit_test(unit.network_beacon SOURCES unit/network_beacon_test.cpp
             unit/network_gradient_test.cpp unit/network_neighbours_test.cpp
  EVERYWHERE unit/network_tree_test.cpp unit/network_coordinates_test.cpp
  NEEDS rubicon_network)
rubicon_fuzz(network_beacon SOURCE fuzz/network_beacon.cpp NEEDS rubicon_network)
rubicon_fuzz(network_messages SOURCE fuzz/network_messages.cpp NEEDS rubicon_network)
