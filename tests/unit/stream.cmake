rubicon_unit_test(unit.stream SOURCES unit/stream_message_test.cpp unit/stream_local_test.cpp
             unit/stream_sensor_test.cpp unit/stream_remote_test.cpp unit/stream_resume_test.cpp
             unit/stream_ends_test.cpp unit/stream_random_test.cpp unit/stream_reliable_test.cpp
             NEEDS rubicon_stream)
rubicon_fuzz(stream_message SOURCE fuzz/stream_message.cpp NEEDS rubicon_stream)
