// Which Rubicon this is.
#pragma once

namespace rubicon::cli {

/// `0.1.0`. Two of the same version understand each other's messages.
extern const char* const version;

} // namespace rubicon::cli
