rubicon_unit_test(unit.peis SOURCES
  unit/peis_golden_test.cpp unit/peis_link_test.cpp unit/peis_link_url_test.cpp unit/peis_key_test.cpp
  unit/peis_queue_test.cpp unit/peis_routing_test.cpp unit/peis_delivery_test.cpp
  unit/peis_p2p_test.cpp unit/peis_p2p_parts_test.cpp unit/peis_network_classes_test.cpp unit/peis_tuple_space_test.cpp unit/peis_tuple_append_test.cpp
  unit/peis_own_tuples_test.cpp unit/peis_held_tuples_test.cpp unit/peis_local_subscriptions_test.cpp unit/peis_tuple_hosts_test.cpp
  unit/peis_pending_feeds_test.cpp unit/peis_subscriber_feed_test.cpp
  unit/peis_tuple_limits_test.cpp unit/peis_tuple_pushes_test.cpp unit/peis_tuple_read_test.cpp unit/peis_tuple_statistics_test.cpp unit/peis_meta_test.cpp unit/peis_kernel_test.cpp unit/peis_kernel_clients_test.cpp unit/peis_simulated_media_test.cpp
  unit/peis_network_test.cpp unit/peis_ecology_test.cpp unit/peis_identity_test.cpp unit/peis_network_golden_test.cpp unit/peis_connection_manager_test.cpp unit/peis_package_walk_test.cpp
  unit/peis_requirements_test.cpp unit/peis_transit_test.cpp unit/peis_bluetooth_test.cpp unit/peis_hci_inquiry_test.cpp unit/peis_budget_test.cpp unit/peis_udp_test.cpp unit/peis_hostile_test.cpp unit/peis_limits_test.cpp
  EVERYWHERE unit/peis_incarnations_test.cpp unit/peis_originals_test.cpp unit/peis_fixture.cpp
  NEEDS rubicon_peis
  DEFINE RUBICON_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
rubicon_fuzz(peis_package_stream SOURCE fuzz/peis_package_stream.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_tuple_messages SOURCE fuzz/peis_tuple_messages.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_udp_datagram SOURCE fuzz/peis_udp_datagram.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_hci_event SOURCE fuzz/peis_hci_event.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_meta_tuple SOURCE fuzz/peis_meta_tuple.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_services SOURCE fuzz/peis_services.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_routing_page SOURCE fuzz/peis_routing_page.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_hostile_neighbour SOURCE fuzz/peis_hostile_neighbour.cpp NEEDS rubicon_peis)
rubicon_fuzz(peis_tuple_kernel SOURCE fuzz/peis_tuple_kernel.cpp NEEDS rubicon_peis)
