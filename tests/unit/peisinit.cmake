rubicon_unit_test(unit.peisinit SOURCES unit/peisinit_supervisor_test.cpp unit/peisinit_random_test.cpp
             NEEDS rubicon_peisinit)
