rubicon_unit_test(unit.smepp SOURCES
  unit/smepp_attack_test.cpp unit/smepp_description_test.cpp unit/smepp_energy_test.cpp unit/smepp_event_test.cpp unit/smepp_flood_test.cpp unit/smepp_intruder_test.cpp
  unit/smepp_group_test.cpp unit/smepp_line_test.cpp unit/smepp_messages_test.cpp unit/smepp_security_test.cpp unit/smepp_sync_test.cpp
  unit/smepp_world.cpp
  NEEDS rubicon_smepp)
foreach(target smepp_codec smepp_message)
  rubicon_fuzz(${target} SOURCE fuzz/${target}.cpp NEEDS rubicon_smepp)
endforeach()
