rubicon_unit_test(unit.io SOURCES unit/io/certificate_list_test.cpp
  unit/io/certificates_test.cpp unit/io/stored_number_test.cpp unit/io/loop_test.cpp unit/io/packet_test.cpp unit/io/pcap_file_test.cpp unit/io/pcapng_test.cpp
  unit/io/process_test.cpp unit/io/revocations_test.cpp unit/io/serial_test.cpp
  unit/io/signal_test.cpp unit/io/tcp_test.cpp unit/io/tls_test.cpp unit/io/udp_socket_test.cpp unit/io/udp_test.cpp unit/io/unwaiting_test.cpp unit/io/web_test.cpp
  EVERYWHERE unit/io/large_pages_test.cpp unit/io/spare_memory_test.cpp
  NEEDS rubicon_io OpenSSL::Crypto)
