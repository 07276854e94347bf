// How steps, values and times read.
#pragma once

#include <string>

#include "explain/traces.hpp"

namespace rubicon::explain {

/// Text in quotes, other octets in hexadecimal; long ones are cut off. Safe for a terminal.
[[nodiscard]] std::string value_text(const bytes& value, bool is_text);

/// `kitchen.fan.switch = on`
[[nodiscard]] std::string assignment(const tuple_value& x);

/// Of a group of SMEPP Light: nobody can read it.
[[nodiscard]] bool is_event(const message& x);

/// `4 octets (00d7 01c2)`
[[nodiscard]] std::string content_text(const message& x);

/// What a step is about: `kitchen/gateway`, `proxy kitchen.fan`, `kitchen/fan → sink`.
[[nodiscard]] std::string where(const traces& all, const node& x);

/// `radio: received at try 2: collision`
[[nodiscard]] std::string what(const traces& all, const node& x);

/// `12.3 ms`, `1.2 s`
[[nodiscard]] std::string span(duration x);

/// `AM type 2`, or what it is on a channel or in a tunnel.
[[nodiscard]] std::string kind_of(const message& x);

} // namespace rubicon::explain
