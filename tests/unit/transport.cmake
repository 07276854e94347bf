rubicon_unit_test(unit.transport SOURCES unit/transport_segment_test.cpp unit/transport_messenger_test.cpp
             unit/transport_fragments_test.cpp unit/transport_tunnels_test.cpp
  EVERYWHERE unit/transport_tunnels_random_test.cpp
  NEEDS rubicon_transport)
rubicon_fuzz(transport_segment SOURCE fuzz/transport_segment.cpp NEEDS rubicon_transport)
rubicon_fuzz(transport_fragments SOURCE fuzz/transport_fragments.cpp NEEDS rubicon_transport)
rubicon_fuzz(transport_tunnel SOURCE fuzz/transport_tunnel.cpp NEEDS rubicon_transport)
