rubicon_unit_test(unit.explain SOURCES
  unit/explain/record_test.cpp unit/explain/message_test.cpp unit/explain/tuple_test.cpp
  unit/explain/growth_test.cpp unit/explain/media_test.cpp
  NEEDS rubicon_explain)
rubicon_fuzz(run_record SOURCE fuzz/files/run_record.cpp NEEDS rubicon_explain rubicon_exports)
