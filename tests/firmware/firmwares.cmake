# Firmwares of motes, which tests load. They are C11, whatever the compiler of all else.
set(RUBICON_FIRMWARES ${CMAKE_CURRENT_BINARY_DIR}/firmware)
set(firmware_files "")

# rubicon_firmware(NAME SOURCE [option...]): NAME.so in RUBICON_FIRMWARES.
function(rubicon_firmware name source)
  set(made ${RUBICON_FIRMWARES}/${name}.so)
  add_custom_command(OUTPUT ${made}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${RUBICON_FIRMWARES}
    COMMAND ${CMAKE_CXX_COMPILER} -x c -std=c11 -O1 -Wall -Wextra -Wpedantic -Werror -fPIC -shared
            -I${PROJECT_SOURCE_DIR}/src/firmware ${ARGN} -o ${made} ${source}
    DEPENDS ${source} ${PROJECT_SOURCE_DIR}/src/firmware/rubicon_mote.h VERBATIM)
  set(firmware_files ${firmware_files} ${made} PARENT_SCOPE)
endfunction()

rubicon_firmware(flood ${PROJECT_SOURCE_DIR}/share/templates/firmware/flood.c)
rubicon_firmware(pair ${CMAKE_CURRENT_SOURCE_DIR}/firmware/pair.c)
rubicon_firmware(version7 ${CMAKE_CURRENT_SOURCE_DIR}/firmware/pair.c -DTEST_VERSION=7)
rubicon_firmware(loops ${CMAKE_CURRENT_SOURCE_DIR}/firmware/failing.c -DTEST_FAILURE=1)
rubicon_firmware(crashes ${CMAKE_CURRENT_SOURCE_DIR}/firmware/failing.c -DTEST_FAILURE=2)
rubicon_firmware(wants_memory ${CMAKE_CURRENT_SOURCE_DIR}/firmware/failing.c -DTEST_FAILURE=3)
rubicon_firmware(empty ${CMAKE_CURRENT_SOURCE_DIR}/firmware/empty.c)
add_custom_target(firmwares DEPENDS ${firmware_files})

# rubicon_adapted_firmware(NAME SOURCE ADAPTER [argument...]): NAME.so, which tools/firmware/ADAPTER makes of a library
# that exports what the firmware of another system does.
function(rubicon_adapted_firmware name source adapter)
  set(tools ${PROJECT_SOURCE_DIR}/tools/firmware)
  set(inner ${RUBICON_FIRMWARES}/${name}.inner)
  file(GLOB_RECURSE adapters CONFIGURE_DEPENDS ${tools}/*)
  add_custom_command(OUTPUT ${RUBICON_FIRMWARES}/${name}.so
    COMMAND ${CMAKE_COMMAND} -E make_directory ${RUBICON_FIRMWARES}
    COMMAND ${CMAKE_CXX_COMPILER} -x c -std=c11 -O1 -Wall -Wextra -Wpedantic -Werror -fPIC -shared
            -I${tools}/tinyos -o ${inner} ${source}
    COMMAND ${CMAKE_COMMAND} -E env CC=${CMAKE_CXX_COMPILER}
            ${tools}/${adapter} ${inner} ${RUBICON_FIRMWARES}/${name}.so ${ARGN}
    DEPENDS ${source} ${adapters} ${PROJECT_SOURCE_DIR}/src/firmware/rubicon_mote.h
    VERBATIM)
  add_custom_target(${name}_firmware DEPENDS ${RUBICON_FIRMWARES}/${name}.so)
  add_dependencies(firmwares ${name}_firmware)
endfunction()

rubicon_adapted_firmware(contiki ${CMAKE_CURRENT_SOURCE_DIR}/firmware/contiki_like.c contiki-ng)
rubicon_adapted_firmware(tinyos ${CMAKE_CURRENT_SOURCE_DIR}/firmware/tinyos_like.c tinyos-sim App)
