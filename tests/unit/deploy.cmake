rubicon_unit_test(unit.deploy SOURCES unit/deploy_bundle_test.cpp unit/deploy_fault_sentence_test.cpp
  unit/deploy_host_access_test.cpp unit/deploy_news_log_test.cpp NEEDS rubicon_deploy)
