// What a message of a rosbridge is about, without reading the rest of it.
#pragma once

#include <string>
#include <string_view>

namespace rubicon::bridge {

/// The topic of a message that publishes something; empty if it is of another kind or malformed
/// before that. What follows `op` and `topic` is not looked at, and may be anything.
[[nodiscard]] std::string topic_of_publication(std::string_view text);

} // namespace rubicon::bridge
