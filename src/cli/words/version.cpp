#include "cli/words/version.hpp"

namespace rubicon::cli {

const char* const version = RUBICON_VERSION;

} // namespace rubicon::cli
