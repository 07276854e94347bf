rubicon_unit_test(unit.stream SOURCES unit/stream/message_test.cpp unit/stream/local_test.cpp
             unit/stream/sensor_test.cpp unit/stream/remote_test.cpp unit/stream/resume_test.cpp
             unit/stream/ends_test.cpp unit/stream/random_test.cpp unit/stream/reliable_test.cpp
             NEEDS rubicon_stream)
rubicon_fuzz(stream_message SOURCE fuzz/stream_message.cpp NEEDS rubicon_stream)
