rubicon_test(unit.network SOURCES unit/network_packet_test.cpp unit/network_star_test.cpp
             unit/network_event_test.cpp
             NEEDS rubicon_network)
rubicon_fuzz(island_packet SOURCE fuzz/island_packet.cpp NEEDS rubicon_network)
rubicon_fuzz(sink_event SOURCE fuzz/sink_event.cpp NEEDS rubicon_network)
