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

# rubicon_batches(TARGET [SIZE]): batches of SIZE files, 12 unless said, of those without properties of their own, in the
# order of its list: those that include what is slow to compile (JSON, Beast) stand together there. Names
# without linkage are the target's, not the file's, by this. CMake's own batches would name their files by full paths:
# no other checkout could find in the compiler cache what this one has compiled, nor the copy of tools/mutate.
function(rubicon_batches target)
  set(size 12 ${ARGN})
  list(GET size -1 size)
  if(NOT RUBICON_BATCHES)
    return()
  endif()
  # When the folder has been read, all properties are known.
  cmake_language(EVAL CODE "cmake_language(DEFER CALL rubicon_write_batches [[${target}]] ${size})")
  # A batch includes its files: to GCC, classes with members of a file's own types stand in headers.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-subobject-linkage>)
endfunction()

function(rubicon_write_batches target size)
  get_target_property(files ${target} SOURCES)
  list(FILTER files INCLUDE REGEX "[.]cpp$") # no objects of others
  set(count 0)
  set(batches "")
  foreach(file ${files})
    math(EXPR batch "${count} / ${size}")
    math(EXPR count "${count} + 1")
    set(is_alone OFF)
    foreach(property UNITY_GROUP SKIP_UNITY_BUILD_INCLUSION COMPILE_OPTIONS COMPILE_DEFINITIONS)
      get_source_file_property(value ${file} ${property})
      if(value)
        set(is_alone ON)
      endif()
    endforeach()
    if(NOT is_alone)
      set_source_files_properties(${file} PROPERTIES HEADER_FILE_ONLY ON)
      cmake_path(ABSOLUTE_PATH file)
      cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
      string(APPEND batch_${batch} "#include \"${file}\"\n")
      list(APPEND batches ${batch})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES batches)
  foreach(batch ${batches})
    file(CONFIGURE OUTPUT ${target}_batch_${batch}.cpp CONTENT "${batch_${batch}}")
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/${target}_batch_${batch}.cpp)
  endforeach()
endfunction()

# rubicon_room(NAME SOURCES file... NEEDS target...): one room, one library, linked with the rooms that it may
# include and with NEEDS. A room without sources of its own is an interface library. Its headers that most
# of its files include are precompiled with `PRECOMPILE header...`, or shared with `PRECOMPILED_BY room`;
# else it shares those of the standard library. A COLD one runs seldom and briefly: in a release it is optimized less, has
# no debug information and is compiled in larger batches, which takes half of the time.
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
    set(batch 12)
    set(kind hot)
    if(room_COLD AND CMAKE_BUILD_TYPE STREQUAL "Release")
      target_compile_options(rubicon_${name} PRIVATE -Og -g0)
      set(batch 24)
      set(kind cold)
    endif()
    set_target_properties(rubicon_${name} PROPERTIES RUBICON_KIND ${kind})
    if(room_PRECOMPILE)
      target_precompile_headers(rubicon_${name} PRIVATE ${standard_headers} ${room_PRECOMPILE})
    elseif(room_PRECOMPILED_BY)
      get_target_property(other_kind rubicon_${room_PRECOMPILED_BY} RUBICON_KIND)
      if(NOT kind STREQUAL other_kind)
        message(FATAL_ERROR "${name} and ${room_PRECOMPILED_BY} share precompiled headers, but not options of optimization")
      endif()
      target_precompile_headers(rubicon_${name} REUSE_FROM rubicon_${room_PRECOMPILED_BY})
    else()
      rubicon_standard_headers(rubicon_${name} ${kind})
    endif()
    rubicon_batches(rubicon_${name} ${batch})
  else()
    add_library(rubicon_${name} INTERFACE)
    target_link_libraries(rubicon_${name} INTERFACE rubicon_options ${room_NEEDS})
  endif()
endfunction()

# rubicon_standard_headers(TARGET KIND): those of the standard library, precompiled with the first target of a kind. Both
# kinds have their own: GCC takes its options of optimization from what it has precompiled, not from the command.
function(rubicon_standard_headers target kind)
  get_property(owner GLOBAL PROPERTY rubicon_standard_headers_${kind})
  if(owner)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  else()
    target_precompile_headers(${target} PRIVATE ${standard_headers})
    set_property(GLOBAL PROPERTY rubicon_standard_headers_${kind} ${target})
  endif()
endfunction()

# GCC 12 takes variants that are moved in these files for uninitialised, most of them with sanitizers only.
function(rubicon_quiet_variants)
  set_source_files_properties(${ARGN} PROPERTIES
    COMPILE_OPTIONS $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endfunction()
