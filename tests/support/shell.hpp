// Programs run as a person would run them.
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

#include "support/catch.hpp"

namespace rubicon::test {

struct outcome {
  int status = -1;
  std::string out; ///< standard output, or standard error where that was asked for
};

/// Runs a shell command to its end.
inline outcome shell(const std::string& command) {
  auto* const pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  outcome x;
  std::array<char, 4096> block{};
  for (auto size = fread(block.data(), 1, block.size(), pipe); size > 0;
       size = fread(block.data(), 1, block.size(), pipe))
    x.out.append(block.data(), size);
  const auto ended = pclose(pipe);
  REQUIRE(WIFEXITED(ended)); // no signal, whatever the input
  x.status = WEXITSTATUS(ended);
  return x;
}

} // namespace rubicon::test
