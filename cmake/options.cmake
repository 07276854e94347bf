# What all our code is compiled with, carried by one interface target.
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE ccache)
if(CCACHE)
  # The sloppiness is what lets ccache work with precompiled headers; with the base folder another
  # checkout finds what this one has compiled. A file is looked up by the exact content of all that it includes
  # (CCACHE_DEPEND), not by its preprocessed text: that lacks comments, and GCC takes a precompiled header only for
  # headers with the same octets. The name space leaves behind what was found by preprocessed text.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_DEPEND=1 CCACHE_NAMESPACE=rubicon
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE})
endif()

# Reading headers and instantiating what they have takes most of a file's time: batches of files share it. In a build
# without batches an edit is compiled in a few seconds instead of half a minute, and no file lacks an include.
# The environment may ask for batches in all builds: a machine that builds everything once, such as one of CI, does.
set(batches OFF)
if(DEFINED ENV{RUBICON_BATCHES})
  set(batches $ENV{RUBICON_BATCHES})
endif()
option(RUBICON_BATCHES "Compile the files of a room or unit test in batches" ${batches})

add_library(rubicon_options INTERFACE)
target_compile_features(rubicon_options INTERFACE cxx_std_20)
target_compile_options(rubicon_options INTERFACE
  "$<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wconversion;-Werror>"
  # In a batch a local name shadows that of another file.
  $<BUILD_INTERFACE:$<$<NOT:$<BOOL:${RUBICON_BATCHES}>>:-Wshadow>>
  -ffp-contract=off) # same bits on every machine (docs/architecture.md, Time)
target_include_directories(rubicon_options INTERFACE
  "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src;${PROJECT_SOURCE_DIR}>"
  $<INSTALL_INTERFACE:include/rubicon>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Collecting garbage takes a tenth of the compiler's time: it may have 1 GB before it does.
  target_compile_options(rubicon_options INTERFACE
    "$<BUILD_INTERFACE:-fpch-preprocess;SHELL:--param ggc-min-expand=100;SHELL:--param ggc-min-heapsize=1048576>")
endif()

# Release keeps asserts: they guard our own logic. -g1, that stack traces name lines, takes 5 to 8 % of the time to
# compile (-g a third more): cold rooms are without. What is installed has no debug information.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g1")

if(RUBICON_SANITIZE)
  # CAF binds a reference to a null pointer when a function actor has no arguments: no null check.
  # Each use of an object would be checked for its alignment, size and type too, which takes a quarter of the time
  # to compile: no octets are cast to a wider type, handles are cast by their interface alone, and the address sanitizer
  # sees who leaves an object.
  add_compile_options(-fsanitize=${RUBICON_SANITIZE} -fno-sanitize=null,alignment,object-size,vptr
                      -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${RUBICON_SANITIZE})
  # The tables of the sanitizers are large: no relocations for them, their names packed, and no
  # second copy of each object in an archive (12 GB less).
  add_compile_options(-fno-pie -gz)
  add_link_options(-no-pie -gz)
  if(RUBICON_SANITIZE STREQUAL "thread") # GCC 12 takes variants that are moved for uninitialised
    add_compile_options($<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  endif()
  set(CMAKE_CXX_ARCHIVE_CREATE "<CMAKE_AR> qcT <TARGET> <LINK_FLAGS> <OBJECTS>")
endif()
if(RUBICON_FUZZ) # the fuzzer sees which branches of all rooms an input takes, not only those of its own file
  add_compile_options(-fsanitize=fuzzer-no-link)
  add_link_options(-fsanitize=fuzzer-no-link)
endif()
