rubicon_unit_test(unit.core SOURCES
  unit/core_bytes_test.cpp unit/core_delay_histogram_test.cpp unit/core_math_test.cpp unit/core_message_ledger_test.cpp unit/core_random_test.cpp
  unit/core_decimal_test.cpp unit/core_field_codec_test.cpp unit/core_fields_test.cpp unit/core_ipv4_network_test.cpp unit/core_latency_estimate_test.cpp unit/core_queue_test.cpp unit/core_device_keys_test.cpp unit/core_printable_test.cpp unit/core_provenance_test.cpp unit/core_shared_list_test.cpp unit/core_small_map_test.cpp unit/core_spelling_test.cpp
  NEEDS rubicon_core)
