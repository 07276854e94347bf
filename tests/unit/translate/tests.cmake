rubicon_unit_test(unit.translate SOURCES unit/translate/expression_test.cpp unit/translate/translator_test.cpp NEEDS rubicon_translate)
rubicon_fuzz(translate_expression SOURCE fuzz/translate_expression.cpp NEEDS rubicon_translate)
