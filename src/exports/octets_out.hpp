// Where an exported file goes, part by part.
#pragma once

#include <functional>
#include <string_view>

namespace rubicon::exports {

/// Takes the next octets of a file.
using octets_out = std::function<void(std::string_view)>;

} // namespace rubicon::exports
