rubicon_unit_test(unit.goal SOURCES unit/goal/pursuer_test.cpp
  EVERYWHERE unit/goal/random_test.cpp
  NEEDS rubicon_goal)
