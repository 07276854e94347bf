// The file in which a host leaves a bundle for the runs that it starts.
#pragma once

#include <optional>
#include <string>

#include "deploy/bundle.hpp"

namespace rubicon::cli {

/// @returns empty, or why it is not written
[[nodiscard]] std::string write_bundle(const std::string& path, const deploy::bundle& x);

/// @returns nothing if there is none in the file
[[nodiscard]] std::optional<deploy::bundle> read_bundle(const std::string& path);

} // namespace rubicon::cli
