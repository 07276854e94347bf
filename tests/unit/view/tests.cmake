rubicon_unit_test(unit.view SOURCES
  unit/view/conversation_test.cpp unit/view/sample_test.cpp unit/view/timeline_test.cpp
  NEEDS rubicon_view nlohmann_json::nlohmann_json)
rubicon_fuzz(view_question SOURCE fuzz/view_question.cpp NEEDS rubicon_view)
