// The example files of the repository.
#pragma once

#include <string>
#include <string_view>

#include "actors/run/run.hpp"
#include "testkit/ecology.hpp"

namespace rubicon::test {

/// The description of an example file.
[[nodiscard]] inline config::ecology_description example(std::string_view file) {
  return describe_file(std::string(RUBICON_CONFIG_DIR "/").append(file));
}

} // namespace rubicon::test
