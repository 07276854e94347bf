// Which Rubicon this is.
#pragma once

namespace rubicon::cli {

/// `0.1.0`. What two of the same version tell each other, both understand.
extern const char* const version;

} // namespace rubicon::cli
