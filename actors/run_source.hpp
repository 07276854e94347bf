// Which file a run was made of.
#pragma once

#include <string>

namespace rubicon {

struct run_source {
  std::string file;   ///< as the user named it
  std::string digest; ///< of its text
};

} // namespace rubicon
