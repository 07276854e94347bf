rubicon_unit_test(unit.io SOURCES unit/io_certificate_list_test.cpp
  unit/io_certificates_test.cpp unit/io_stored_number_test.cpp unit/io_loop_test.cpp unit/io_packet_test.cpp unit/io_pcap_file_test.cpp unit/io_pcapng_test.cpp
  unit/io_process_test.cpp unit/io_revocations_test.cpp unit/io_serial_test.cpp
  unit/io_signal_test.cpp unit/io_tcp_test.cpp unit/io_tls_test.cpp unit/io_udp_socket_test.cpp unit/io_udp_test.cpp unit/io_unwaiting_test.cpp unit/io_web_test.cpp
  EVERYWHERE unit/io_spare_memory_test.cpp
  NEEDS rubicon_io OpenSSL::Crypto)
