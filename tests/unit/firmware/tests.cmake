rubicon_unit_test(unit.firmware SOURCES
  unit/firmware/library_test.cpp unit/firmware/remote_code_test.cpp unit/firmware/session_test.cpp
  NEEDS rubicon_firmware rubicon_config
  DEFINE RUBICON_FIRMWARES="${RUBICON_FIRMWARES}")
if(TARGET test_unit.firmware)
  add_dependencies(test_unit.firmware firmwares)
endif()
rubicon_fuzz(firmware_library SOURCE fuzz/firmware/library.cpp NEEDS rubicon_firmware)
