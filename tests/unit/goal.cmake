rubicon_unit_test(unit.goal SOURCES unit/goal_pursuer_test.cpp
  EVERYWHERE unit/goal_random_test.cpp
  NEEDS rubicon_goal)
