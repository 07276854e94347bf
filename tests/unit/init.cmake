rubicon_test(unit.init SOURCES unit/init_supervisor_test.cpp unit/init_random_test.cpp
             NEEDS rubicon_init)
