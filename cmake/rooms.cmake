# rubicon_room(NAME SOURCES file... NEEDS target...): one room, one library, one list of what it may
# include. A room without sources of its own is an interface library.
function(rubicon_room name)
  cmake_parse_arguments(room "" "" "SOURCES;NEEDS" ${ARGN})
  if(room_SOURCES)
    add_library(rubicon_${name} STATIC ${room_SOURCES})
    target_link_libraries(rubicon_${name} PUBLIC rubicon_options ${room_NEEDS})
  else()
    add_library(rubicon_${name} INTERFACE)
    target_link_libraries(rubicon_${name} INTERFACE rubicon_options ${room_NEEDS})
  endif()
endfunction()
