// By what the ends of the control plane know each other.
#pragma once

#include "io/tls/tls_identity.hpp"

namespace rubicon::control {

using io::tls_files;

} // namespace rubicon::control
