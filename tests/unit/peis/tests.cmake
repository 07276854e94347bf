rubicon_unit_test(unit.peis SOURCES
  unit/peis/golden_test.cpp unit/peis/link_test.cpp unit/peis/link_url_test.cpp unit/peis/tuples/key_test.cpp
  unit/peis/queue_test.cpp unit/peis/overlay/routing_test.cpp unit/peis/delivery_test.cpp
  unit/peis/overlay/p2p_test.cpp unit/peis/overlay/p2p_parts_test.cpp unit/peis/overlay/network_classes_test.cpp unit/peis/tuples/tuple_space_test.cpp unit/peis/tuples/tuple_append_test.cpp
  unit/peis/tuples/own_tuples_test.cpp unit/peis/tuples/held_tuples_test.cpp unit/peis/tuples/local_subscriptions_test.cpp unit/peis/tuples/tuple_hosts_test.cpp
  unit/peis/tuples/pending_feeds_test.cpp unit/peis/tuples/subscriber_feed_test.cpp
  unit/peis/tuples/tuple_limits_test.cpp unit/peis/tuples/tuple_pushes_test.cpp unit/peis/tuples/tuple_read_test.cpp unit/peis/tuples/tuple_statistics_test.cpp unit/peis/tuples/meta_test.cpp unit/peis/kernel_test.cpp unit/peis/kernel_parts_test.cpp unit/peis/kernel_clients_test.cpp unit/peis/overlay/simulated_media_test.cpp
  unit/peis/network_test.cpp unit/peis/ecology_test.cpp unit/peis/overlay/identity_test.cpp unit/peis/network_golden_test.cpp unit/peis/overlay/connection_manager_test.cpp unit/peis/package_walk_test.cpp
  unit/peis/requirements_test.cpp unit/peis/overlay/transit_test.cpp unit/peis/overlay/bluetooth_test.cpp unit/peis/overlay/hci_inquiry_test.cpp unit/peis/overlay/budget_test.cpp unit/peis/udp_test.cpp unit/peis/udp_parts_test.cpp unit/peis/overlay/hostile_test.cpp unit/peis/overlay/limits_test.cpp
  EVERYWHERE unit/peis/overlay/incarnations_test.cpp unit/peis/originals_test.cpp unit/peis/fixture.cpp
  NEEDS rubicon_peis
  DEFINE RUBICON_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
rubicon_fuzz(peis_package_stream SOURCE fuzz/peis/peis_package_stream.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_tuple_messages SOURCE fuzz/peis/peis_tuple_messages.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_udp_datagram SOURCE fuzz/peis/peis_udp_datagram.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_hci_event SOURCE fuzz/peis/peis_hci_event.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_meta_tuple SOURCE fuzz/peis/peis_meta_tuple.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_services SOURCE fuzz/peis/peis_services.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_routing_page SOURCE fuzz/peis/peis_routing_page.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_hostile_neighbour SOURCE fuzz/peis/peis_hostile_neighbour.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_tuple_kernel SOURCE fuzz/peis/peis_tuple_kernel.cpp NEEDS rubicon_peis)
