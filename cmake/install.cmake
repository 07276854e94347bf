# `cmake --install build/release --prefix FOLDER`: the binary, and the library with which others
# write theirs: find_package(rubicon), target rubicon::rubicon (docs/applications.md).
include(CMakePackageConfigHelpers)

set(package_folder lib/cmake/rubicon)
list(TRANSFORM RUBICON_ROOMS PREPEND rubicon_ OUTPUT_VARIABLE libraries)
list(APPEND libraries rubicon_options rubicon_scheduler rubicon_actors rubicon_control rubicon_cli rubicon_testkit)

add_library(rubicon_all INTERFACE)
set_target_properties(rubicon_all PROPERTIES EXPORT_NAME rubicon)
target_link_libraries(rubicon_all INTERFACE rubicon_cli)

install(TARGETS rubicon RUNTIME DESTINATION bin)
install(FILES packaging/rubicon-host@.service DESTINATION lib/systemd/system)
install(TARGETS rubicon_all ${libraries} EXPORT rubicon ARCHIVE DESTINATION lib/rubicon)
install(EXPORT rubicon NAMESPACE rubicon:: FILE rubicon-targets.cmake DESTINATION ${package_folder})
install(DIRECTORY src/ DESTINATION include/rubicon FILES_MATCHING PATTERN *.hpp)
install(DIRECTORY actors DESTINATION include/rubicon FILES_MATCHING PATTERN *.hpp)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rubicon-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES cmake/rubicon-config.cmake cmake/dependencies.cmake
              ${PROJECT_BINARY_DIR}/rubicon-config-version.cmake
        DESTINATION ${package_folder})
