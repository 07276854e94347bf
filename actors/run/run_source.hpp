// Which file a run was made of.
#pragma once

#include <string>

namespace rubicon {

struct run_source {
  std::string file;   ///< as the user named it
  std::string digest; ///< of its text
  /// Of the command line, as a shell takes them: what decides what runs beside the file, the seed
  /// and the length, `--mode wall --speed 5`
  std::string options = {};
};

} // namespace rubicon
