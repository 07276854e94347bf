rubicon_unit_test(unit.peisinit SOURCES unit/peisinit/supervisor_test.cpp unit/peisinit/random_test.cpp
             NEEDS rubicon_peisinit)
