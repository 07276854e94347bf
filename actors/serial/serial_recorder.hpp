// Every frame of the serial lines of a run, in a file (ACT-08).
#pragma once

#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "scheduler/trace.hpp"
#include "serial/recording.hpp"

namespace rubicon {

class serial_recorder {
public:
  /// @throws std::runtime_error if the file cannot be made
  explicit serial_recorder(std::string path);

  /// Of what arrives at the PC's end of a line, and what is written there.
  void write(const scheduler::delivery& x);

  /// @returns why the file is not complete; empty: it is
  [[nodiscard]] std::string finish();

private:
  using closer = int (*)(std::FILE*);

  void take(instant at, const std::string& island, serial::direction towards, byte_view octets);

  std::string path_;
  std::unique_ptr<std::FILE, closer> file_;
  std::map<std::pair<std::string, serial::direction>, serial::frame_decoder> decoders_;
  bool failed_ = false;
};

} // namespace rubicon
