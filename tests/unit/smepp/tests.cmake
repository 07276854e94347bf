rubicon_unit_test(unit.smepp SOURCES
  unit/smepp/attack_test.cpp unit/smepp/description_test.cpp unit/smepp/energy_test.cpp unit/smepp/event_test.cpp unit/smepp/flood_test.cpp unit/smepp/intruder_test.cpp
  unit/smepp/group_test.cpp unit/smepp/line_test.cpp unit/smepp/messages_test.cpp unit/smepp/security_test.cpp unit/smepp/sync_test.cpp
  unit/smepp/world.cpp
  NEEDS rubicon_smepp)
foreach(target smepp_codec smepp_message)
  rubicon_fuzz(${target} SOURCE fuzz/${target}.cpp NEEDS rubicon_smepp)
endforeach()
