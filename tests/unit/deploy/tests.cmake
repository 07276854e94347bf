rubicon_unit_test(unit.deploy SOURCES unit/deploy/bundle_test.cpp unit/deploy/fault_sentence_test.cpp
  unit/deploy/host_access_test.cpp unit/deploy/host_metrics_test.cpp unit/deploy/news_log_test.cpp NEEDS rubicon_deploy)
