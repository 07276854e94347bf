// The secrets that a file has written, and which of them a part of its ecology cannot be without.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/plan/ecology.hpp"
#include "config/plan/places.hpp"

namespace rubicon::config {

/// Names of secrets, as secret_place has them.
using secret_names = std::set<std::string>;

[[nodiscard]] std::string master_key_name(const std::string& group);

/// What the motes of a part, and those that its faults make of them, work with. All that is not
/// listed here is sent to no host.
[[nodiscard]] secret_names secrets_of(const ecology_description& part);

/// The same of one fault.
[[nodiscard]] secret_names secrets_of(const ecology_description& all, const fault& x);

/// A file that reads as the other one, with zeros in the place of those secrets, and without its
/// comments: what else they contain is not known. Lines stay where they are.
/// @returns nothing if one of the places is none of a text
[[nodiscard]] std::optional<std::string> without(const std::vector<secret_place>& secrets,
                                                 std::string_view toml);

} // namespace rubicon::config
