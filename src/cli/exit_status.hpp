// What the binary tells the shell.
#pragma once

namespace rubicon::cli {

enum class exit_status : int {
  good = 0,
  violated = 1, ///< the run ended with violations, or two equal runs differed
  refused = 2,  ///< bad command line or file, or output that cannot be written
};

} // namespace rubicon::cli
