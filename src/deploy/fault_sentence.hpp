// A fault in a few words, as somebody types it while an ecology runs: `kill peer robot for 10s`.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "config/ecology.hpp"
#include "deploy/bundle.hpp"

namespace rubicon::deploy {

inline constexpr std::size_t sentence_octets_max = 1024;

/// KIND, then keys and values, as in a [[fault]]: `crash mote kitchen/stove for 10s`. Values are
/// words, or TOML without spaces. `kill mote kitchen/stove` is a crash.
/// @returns the fault, of an ecology as the bundle describes it, or why it is none
[[nodiscard]] std::variant<config::fault, std::string>
fault_of(const bundle& x, std::string_view sentence, const config::extensions& known);

/// The [[fault]] of a sentence that fault_of() takes, as a file has it. @param at `"12s"`
[[nodiscard]] std::string table_of(std::string_view sentence, const std::string& at);

} // namespace rubicon::deploy
