# What find_package(rubicon) reads.
set(RUBICON_ACTORS ON)
include(${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/rubicon-targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/rubicon-kit-targets.cmake OPTIONAL) # if it is installed
