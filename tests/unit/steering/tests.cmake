rubicon_unit_test(unit.steering SOURCES unit/steering/session_test.cpp
  NEEDS rubicon_steering nlohmann_json::nlohmann_json)
rubicon_fuzz(steering_request SOURCE fuzz/steering/steering_request.cpp NEEDS rubicon_steering nlohmann_json::nlohmann_json)
