// Proxy classes that several ecologies of tests have.
#pragma once

#include <string_view>

namespace rubicon::test {

/// For thermometers of type 100, and lamps of type 200 with an actuator.
inline constexpr std::string_view lamp_and_climate = R"(
[[proxy]]
name = "climate"
types = [100]
field = [{ name = "temperature", channel = 1, scale = 0.1, decimals = 1, unit = "C" }]
[[proxy]]
name = "lamp"
types = [200]
field = [{ name = "state", channel = 2, encoding = "u8", words = { 0 = "off", 1 = "on" } }]
input = [{ name = "switch", channel = 2, words = { off = "00", on = "01" } }]
)";

} // namespace rubicon::test
