# `cmake --install build/release --prefix FOLDER --component COMPONENT`, or tools/install, which builds it before:
#   binary   the program without debug information, its systemd unit, pages of the manual, completion in shells, templates of
#            files, and the Python package rubicon (docs/python.md)
#   library  what others write theirs with: find_package(rubicon), target rubicon::rubicon (docs/applications.md)
#   kit      what they test it with: target rubicon::test (docs/testing.md); needs the library
#   debug    the debug information of the binary, where debuggers look for it
# Without `--component`: what is built with the binary, that is the first two.
include(CMakePackageConfigHelpers)

set(package_folder lib/cmake/rubicon)
list(TRANSFORM RUBICON_ROOMS PREPEND rubicon_ OUTPUT_VARIABLE libraries)
list(APPEND libraries rubicon_options rubicon_scheduler rubicon_actors rubicon_cli)

# The names of components are targets too: what has to be built for them.
add_custom_target(binary DEPENDS rubicon)
add_custom_target(library)
add_dependencies(library ${libraries})
add_custom_target(kit DEPENDS library rubicon_testkit)
add_custom_target(debug DEPENDS rubicon)

# Nine tenths of the binary that is built are debug information.
set(parted ${PROJECT_BINARY_DIR}/parted)
string(CONFIGURE [[
  file(MAKE_DIRECTORY "@parted@")
  execute_process(COMMAND_ERROR_IS_FATAL ANY
    COMMAND "@CMAKE_OBJCOPY@" --only-keep-debug --compress-debug-sections "$<TARGET_FILE:rubicon>" rubicon.debug
    WORKING_DIRECTORY "@parted@")
  execute_process(COMMAND_ERROR_IS_FATAL ANY
    COMMAND "@CMAKE_OBJCOPY@" --strip-all --remove-section=.comment --add-gnu-debuglink=rubicon.debug "$<TARGET_FILE:rubicon>" rubicon
    WORKING_DIRECTORY "@parted@")
]] part @ONLY)
install(CODE "${part}" COMPONENT binary)
install(PROGRAMS ${parted}/rubicon DESTINATION bin COMPONENT binary)
# The binary writes them of its own options and keys. The date follows SOURCE_DATE_EPOCH.
string(CONFIGURE [[
  file(REMOVE_RECURSE "@parted@/manual")
  file(MAKE_DIRECTORY "@parted@/manual" "@parted@/completion")
  string(TIMESTAMP day "%Y-%m-%d" UTC)
  execute_process(COMMAND_ERROR_IS_FATAL ANY
    COMMAND "$<TARGET_FILE:rubicon>" help --pages "@parted@/manual" --date "${day}")
  foreach(shell_and_file "bash rubicon" "zsh _rubicon" "fish rubicon.fish")
    separate_arguments(shell_and_file)
    list(GET shell_and_file 0 shell)
    list(GET shell_and_file 1 file)
    execute_process(COMMAND_ERROR_IS_FATAL ANY
      COMMAND "$<TARGET_FILE:rubicon>" completion "${shell}" OUTPUT_FILE "@parted@/completion/${file}")
  endforeach()
]] write_manual @ONLY)
install(CODE "${write_manual}" COMPONENT binary)
foreach(number 1 5)
  install(DIRECTORY ${parted}/manual/ DESTINATION share/man/man${number} COMPONENT binary FILES_MATCHING PATTERN *.${number})
endforeach()
install(FILES ${parted}/completion/rubicon DESTINATION share/bash-completion/completions COMPONENT binary)
install(FILES ${parted}/completion/_rubicon DESTINATION share/zsh/site-functions COMPONENT binary)
install(FILES ${parted}/completion/rubicon.fish DESTINATION share/fish/vendor_completions.d COMPONENT binary)
install(DIRECTORY share/templates DESTINATION share/rubicon COMPONENT binary FILES_MATCHING PATTERN *.toml
        PATTERN firmware EXCLUDE PATTERN lua EXCLUDE PATTERN python EXCLUDE)
# Firmware of motes in C includes <rubicon_mote.h>.
install(FILES src/firmware/rubicon_mote.h DESTINATION include COMPONENT binary)
install(PROGRAMS tools/firmware/contiki-ng tools/firmware/tinyos-sim DESTINATION share/rubicon/firmware COMPONENT binary)
install(FILES tools/firmware/contiki_ng.c tools/firmware/inner_library.h tools/firmware/tinyos_sim.c
        DESTINATION share/rubicon/firmware COMPONENT binary)
install(DIRECTORY tools/firmware/tinyos DESTINATION share/rubicon/firmware COMPONENT binary)
# It names the binary by where this is installed, which `cmake --install` may be told last.
install(CODE "set(RUBICON_BINARY_FOLDER \"\${CMAKE_INSTALL_PREFIX}/bin\")
  configure_file(\"${PROJECT_SOURCE_DIR}/packaging/rubicon-host@.service.in\" \"${parted}/rubicon-host@.service\" @ONLY)"
  COMPONENT binary)
install(FILES ${parted}/rubicon-host@.service DESTINATION lib/systemd/system COMPONENT binary)
# Where Debian's Python finds it, with the prefix /usr.
install(DIRECTORY python/rubicon DESTINATION lib/python3/dist-packages COMPONENT binary FILES_MATCHING PATTERN *.py
        PATTERN __pycache__ EXCLUDE)
install(CODE "${part}" COMPONENT debug EXCLUDE_FROM_ALL)
install(FILES ${parted}/rubicon.debug DESTINATION bin/.debug COMPONENT debug EXCLUDE_FROM_ALL)

add_library(rubicon_all INTERFACE)
set_target_properties(rubicon_all PROPERTIES EXPORT_NAME rubicon)
target_link_libraries(rubicon_all INTERFACE rubicon_cli)
install(TARGETS rubicon_all ${libraries} EXPORT rubicon ARCHIVE DESTINATION lib/rubicon COMPONENT library)
install(EXPORT rubicon NAMESPACE rubicon:: FILE rubicon-targets.cmake DESTINATION ${package_folder} COMPONENT library)
install(DIRECTORY src/ DESTINATION include/rubicon COMPONENT library
        FILES_MATCHING PATTERN *.hpp PATTERN rubicon_mote.h PATTERN testkit EXCLUDE REGEX view/page$ EXCLUDE)
install(DIRECTORY actors DESTINATION include/rubicon COMPONENT library FILES_MATCHING PATTERN *.hpp)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rubicon-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES cmake/rubicon-config.cmake cmake/dependencies.cmake
              ${PROJECT_BINARY_DIR}/rubicon-config-version.cmake
        DESTINATION ${package_folder} COMPONENT library)

install(TARGETS rubicon_testkit EXPORT rubicon-kit ARCHIVE DESTINATION lib/rubicon COMPONENT kit EXCLUDE_FROM_ALL)
install(EXPORT rubicon-kit NAMESPACE rubicon:: FILE rubicon-kit-targets.cmake DESTINATION ${package_folder}
        COMPONENT kit EXCLUDE_FROM_ALL)
install(DIRECTORY src/testkit DESTINATION include/rubicon COMPONENT kit EXCLUDE_FROM_ALL FILES_MATCHING PATTERN *.hpp)

# Of applications' own debug information nothing is lost.
string(CONFIGURE [[
  file(GLOB archives "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/lib/rubicon/*.a")
  execute_process(COMMAND_ERROR_IS_FATAL ANY
    COMMAND "@CMAKE_STRIP@" --strip-debug --remove-section=.comment --preserve-dates ${archives})
]] strip_archives @ONLY)
install(CODE "${strip_archives}" COMPONENT library)
install(CODE "${strip_archives}" COMPONENT kit EXCLUDE_FROM_ALL)
