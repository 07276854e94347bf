# Debian packages only; tools/install-dependencies lists them.
set(Boost_NO_WARN_NEW_VERSIONS ON)
find_package(Boost 1.74 REQUIRED)
find_package(tomlplusplus 3.3 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(OpenSSL 3 REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(pugixml 1.12 REQUIRED)
find_package(yaml-cpp 0.7 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Threads REQUIRED)
# libpcap has no CMake package.
find_path(PCAP_INCLUDE_DIR pcap/pcap.h REQUIRED)
find_library(PCAP_LIBRARY pcap REQUIRED)
add_library(pcap::pcap UNKNOWN IMPORTED)
set_target_properties(pcap::pcap PROPERTIES
  IMPORTED_LOCATION ${PCAP_LIBRARY}
  INTERFACE_INCLUDE_DIRECTORIES ${PCAP_INCLUDE_DIR})
# Neither has libmosquitto.
find_path(MOSQUITTO_INCLUDE_DIR mosquitto.h REQUIRED)
find_library(MOSQUITTO_LIBRARY mosquitto REQUIRED)
add_library(mosquitto::mosquitto UNKNOWN IMPORTED)
set_target_properties(mosquitto::mosquitto PROPERTIES
  IMPORTED_LOCATION ${MOSQUITTO_LIBRARY}
  INTERFACE_INCLUDE_DIRECTORIES ${MOSQUITTO_INCLUDE_DIR})
# Debian's Lua has no CMake package. This one is compiled as C++: its errors are exceptions.
find_path(LUA_INCLUDE_DIR lua5.4/lua.h REQUIRED)
find_library(LUA_LIBRARY lua5.4-c++ REQUIRED)
add_library(lua::lua UNKNOWN IMPORTED)
set_target_properties(lua::lua PROPERTIES
  IMPORTED_LOCATION ${LUA_LIBRARY}
  INTERFACE_INCLUDE_DIRECTORIES ${LUA_INCLUDE_DIR})

if(RUBICON_ACTORS)
  find_package(spdlog 1.10 REQUIRED)
  find_package(CLI11 2.1 REQUIRED)
  # CAF 0.17 has no CMake package.
  find_path(CAF_INCLUDE_DIR caf/all.hpp REQUIRED)
  find_library(CAF_CORE_LIBRARY caf_core REQUIRED)
  add_library(caf::core UNKNOWN IMPORTED)
  set_target_properties(caf::core PROPERTIES
    IMPORTED_LOCATION ${CAF_CORE_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${CAF_INCLUDE_DIR}
    INTERFACE_COMPILE_DEFINITIONS CAF_ENABLE_TYPE_ID_CHECKS
    # gcc takes the values that CAF's deserializer is about to fill for uninitialized ones.
    INTERFACE_COMPILE_OPTIONS $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
    INTERFACE_LINK_LIBRARIES Threads::Threads)
endif()
if(RUBICON_TESTS)
  find_package(Catch2 REQUIRED)
endif()
