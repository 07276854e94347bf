rubicon_unit_test(unit.explain SOURCES
  unit/explain_record_test.cpp unit/explain_message_test.cpp unit/explain_tuple_test.cpp
  unit/explain_growth_test.cpp unit/explain_media_test.cpp
  NEEDS rubicon_explain)
rubicon_fuzz(run_record SOURCE fuzz/run_record.cpp NEEDS rubicon_explain)
