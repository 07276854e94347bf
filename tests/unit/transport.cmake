rubicon_test(unit.transport SOURCES unit/transport_segment_test.cpp unit/transport_endpoint_test.cpp
             unit/transport_pieces_test.cpp unit/transport_tunnels_test.cpp
             unit/transport_tunnels_random_test.cpp
             NEEDS rubicon_transport)
rubicon_fuzz(transport_segment SOURCE fuzz/transport_segment.cpp NEEDS rubicon_transport)
rubicon_fuzz(transport_pieces SOURCE fuzz/transport_pieces.cpp NEEDS rubicon_transport)
rubicon_fuzz(transport_tunnel SOURCE fuzz/transport_tunnel.cpp NEEDS rubicon_transport)
