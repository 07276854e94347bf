// Which file a run was made of.
#pragma once

#include <string>
#include <vector>

namespace rubicon {

struct run_source {
  std::string file;   ///< as the user named it
  std::string digest; ///< of its text
  /// Of the command line, word by word: what decides what runs beside the file, the seed and the
  /// length, `--mode`, `wall`
  std::vector<std::string> options = {};
};

} // namespace rubicon
