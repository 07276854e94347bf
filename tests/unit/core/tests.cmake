rubicon_unit_test(unit.core SOURCES
  unit/core/bytes_test.cpp unit/core/delay_histogram_test.cpp unit/core/math_test.cpp unit/core/message_ledger_test.cpp unit/core/random_test.cpp
  unit/core/changes_test.cpp unit/core/decimal_test.cpp unit/core/field_codec_test.cpp unit/core/fields_test.cpp unit/core/ipv4_network_test.cpp unit/core/json_test.cpp unit/core/latency_estimate_test.cpp unit/core/queue_test.cpp unit/core/device_keys_test.cpp unit/core/printable_test.cpp unit/core/provenance_test.cpp unit/core/report_schedule_test.cpp unit/core/shared_list_test.cpp unit/core/small_map_test.cpp unit/core/spelling_test.cpp
  NEEDS rubicon_core)
