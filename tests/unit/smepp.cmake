rubicon_test(unit.smepp SOURCES
  unit/smepp_description_test.cpp unit/smepp_messages_test.cpp unit/smepp_security_test.cpp
  NEEDS rubicon_smepp)
