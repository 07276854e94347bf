// Tuples and peers as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peis/tuples/tuple.hpp"

namespace rubicon::cli {

/// The value as a line of text: text with what could disturb a terminal replaced, binary octets in
/// hexadecimal.
[[nodiscard]] std::string value_text(const peis::tuple& x);

/// Whether a kernel keeps it about itself: `kernel.*`.
[[nodiscard]] bool is_of_kernel(const peis::tuple& x);

/// `{"owner": 7, "key": "lamp.state", "value": "on", ...}`; binary values as `value_hex`; times in
/// Unix seconds.
[[nodiscard]] nlohmann::ordered_json to_json(const peis::tuple& x);

/// One line. Octets that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string line_of(const nlohmann::ordered_json& x);

/// An array, one element a line.
[[nodiscard]] std::string lines_of(const std::vector<nlohmann::ordered_json>& all);

} // namespace rubicon::cli
