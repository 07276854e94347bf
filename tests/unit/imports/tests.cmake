rubicon_unit_test(unit.imports SOURCES unit/imports/cooja_test.cpp unit/imports/gzip_test.cpp unit/imports/iotlab_test.cpp
  unit/imports/k7_test.cpp unit/imports/limits_test.cpp unit/imports/otns_test.cpp unit/imports/places_test.cpp
  unit/imports/setdest_test.cpp unit/imports/sink_test.cpp unit/imports/tossim_test.cpp unit/imports/zep_test.cpp
  NEEDS rubicon_imports rubicon_config ZLIB::ZLIB)
rubicon_fuzz(gzip SOURCE fuzz/files/gzip.cpp NEEDS rubicon_imports ZLIB::ZLIB)
rubicon_fuzz(imports SOURCE fuzz/files/imports.cpp NEEDS rubicon_imports)
