// The exit status of the binary.
#pragma once

namespace rubicon::cli {

enum class exit_status : int {
  good = 0,
  failed = 1,        ///< nobody answered, or not in time; a certificate is no good
  violated = 1,      ///< the run ended with violations, or two equal runs differed
  refused = 2,       ///< bad command line or file, or output that cannot be written
  interrupted = 130, ///< Ctrl-C came before the end; as shells report SIGINT
};

} // namespace rubicon::cli
