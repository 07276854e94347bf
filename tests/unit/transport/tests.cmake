rubicon_unit_test(unit.transport SOURCES unit/transport/segment_test.cpp unit/transport/messenger_test.cpp
             unit/transport/fragments_test.cpp unit/transport/tunnels_test.cpp
  EVERYWHERE unit/transport/tunnels_random_test.cpp
  NEEDS rubicon_transport)
rubicon_fuzz(transport_segment SOURCE fuzz/transport/transport_segment.cpp NEEDS rubicon_transport)
rubicon_fuzz(transport_fragments SOURCE fuzz/transport/transport_fragments.cpp NEEDS rubicon_transport)
rubicon_fuzz(transport_tunnel SOURCE fuzz/transport/transport_tunnel.cpp NEEDS rubicon_transport)
