# What most files include of the standard library: reading it takes longer than most files' own code.
set(standard_headers
  <algorithm> <array> <charconv> <chrono> <cmath> <deque> <functional> <map> <memory> <optional>
  <ranges> <set> <span> <string> <string_view> <utility> <variant> <vector>)

# src/rooms: the rooms, needed ones before their users, in `rooms_listed`, and the rooms that each needs in
# `NAME_rooms`. CMake looks at it again when it changes.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/rooms)
file(READ ${PROJECT_SOURCE_DIR}/src/rooms text)
string(REGEX MATCHALL "(^|\n)[a-z]+ [|][^|]*[|]" lines "${text}")
foreach(line ${lines})
  string(REGEX MATCH "([a-z]+) [|]([^|]*)[|]" matched "${line}")
  set(room ${CMAKE_MATCH_1})
  string(REGEX REPLACE "/[^ ]*" "" needs "${CMAKE_MATCH_2}") # of a header its room
  separate_arguments(needs)
  list(REMOVE_DUPLICATES needs)
  list(APPEND rooms_listed ${room})
  set(${room}_rooms ${needs})
endforeach()

# rubicon_batches(TARGET [SIZE]): batches of SIZE files, 12 unless said, of those that have no group yet. Names without
# linkage are the room's, not the file's, by this.
function(rubicon_batches target)
  set(size 12 ${ARGN})
  list(GET size -1 size)
  if(NOT RUBICON_BATCHES)
    return()
  endif()
  get_target_property(files ${target} SOURCES)
  set(count 0)
  foreach(file ${files})
    get_source_file_property(group ${file} UNITY_GROUP)
    if(NOT group)
      math(EXPR batch "${count} / ${size}")
      math(EXPR count "${count} + 1")
      set_source_files_properties(${file} PROPERTIES UNITY_GROUP batch_${batch})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # A batch includes its files: to GCC, classes with members of a file's own types stand in headers.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-subobject-linkage>)
endfunction()

# rubicon_room(NAME SOURCES file... NEEDS target...): one room, one library, linked with the rooms that it may
# include and with NEEDS. A room without sources of its own is an interface library. Its headers that most
# of its files include are precompiled with `PRECOMPILE header...`, or shared with `PRECOMPILED_BY room`;
# else it shares the core's. A COLD one runs seldom and briefly: it is optimized less, which takes a quarter of the time.
function(rubicon_room name)
  cmake_parse_arguments(room "COLD" "PRECOMPILED_BY" "SOURCES;NEEDS;PRECOMPILE" ${ARGN})
  foreach(other ${${name}_rooms})
    if(TARGET rubicon_${other}) # a build of a few rooms may lack one whose headers alone are used
      list(APPEND room_NEEDS rubicon_${other})
    endif()
  endforeach()
  if(room_SOURCES)
    add_library(rubicon_${name} STATIC ${room_SOURCES})
    target_link_libraries(rubicon_${name} PUBLIC rubicon_options ${room_NEEDS})
    if(room_COLD)
      target_compile_options(rubicon_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
    if(room_PRECOMPILE)
      target_precompile_headers(rubicon_${name} PRIVATE ${standard_headers} ${room_PRECOMPILE})
    elseif(name STREQUAL "core")
      target_precompile_headers(rubicon_core PRIVATE ${standard_headers})
    elseif(room_PRECOMPILED_BY)
      target_precompile_headers(rubicon_${name} REUSE_FROM rubicon_${room_PRECOMPILED_BY})
    else()
      target_precompile_headers(rubicon_${name} REUSE_FROM rubicon_core)
    endif()
    rubicon_batches(rubicon_${name})
  else()
    add_library(rubicon_${name} INTERFACE)
    target_link_libraries(rubicon_${name} INTERFACE rubicon_options ${room_NEEDS})
  endif()
endfunction()

# GCC 12 takes variants that are moved in these files for uninitialised, most of them with sanitizers only.
function(rubicon_quiet_variants)
  set_source_files_properties(${ARGN} PROPERTIES
    COMPILE_OPTIONS $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endfunction()
