rubicon_unit_test(unit.network SOURCES unit/network/packet_test.cpp unit/network/places_test.cpp
             unit/network/event_test.cpp
             unit/network/channels/hop_queue_test.cpp unit/network/channels/set_up_parts_test.cpp
             unit/network/channels_test.cpp unit/network/clock_parts_test.cpp unit/network/collection_test.cpp unit/network/sequence_windows_test.cpp
             unit/network/clock_line_test.cpp unit/network/router_parts_test.cpp unit/network/router_test.cpp
             unit/network/schedule_test.cpp unit/network/search_test.cpp
             unit/network/turns_test.cpp
  EVERYWHERE unit/network/backbone_test.cpp unit/network/clock_test.cpp unit/network/reference_test.cpp
  NEEDS rubicon_network rubicon_serial)
rubicon_fuzz(island_packet SOURCE fuzz/island_packet.cpp NEEDS rubicon_network)
rubicon_fuzz(sink_event SOURCE fuzz/sink_event.cpp NEEDS rubicon_network)
rubicon_unit_test(unit.network_beacon SOURCES unit/network/beacon_test.cpp
             unit/network/gradient_test.cpp unit/network/neighbours_test.cpp
  EVERYWHERE unit/network/tree_test.cpp unit/network/coordinates_test.cpp
  NEEDS rubicon_network)
rubicon_fuzz(network_beacon SOURCE fuzz/network_beacon.cpp NEEDS rubicon_network)
rubicon_fuzz(network_messages SOURCE fuzz/network_messages.cpp NEEDS rubicon_network)
