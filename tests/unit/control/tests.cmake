# What computers of a deployment tell each other.
rubicon_unit_test(control SOURCES control/admission_test.cpp control/frame_test.cpp control/octets_test.cpp
  control/refusal_log_test.cpp control/server_test.cpp NEEDS rubicon_control)
foreach(target control_answer control_frame control_question control_revoked control_tls)
  rubicon_fuzz(${target} SOURCE fuzz/control/${target}.cpp NEEDS rubicon_control)
endforeach()
