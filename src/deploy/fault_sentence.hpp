// A fault or a change in a few words, as somebody types it while an ecology runs: `kill peer robot
// for 10s`, `rate mote kitchen/stove period 5s`.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "config/plan/ecology.hpp"
#include "deploy/bundle.hpp"

namespace rubicon::deploy {

inline constexpr std::size_t sentence_octets_max = 1024;

/// KIND, then keys and values, as in a [[fault]], or in a [[change]] if the kind is one of those:
/// `crash mote kitchen/stove for 10s`. Values are words, or TOML without spaces. `kill mote
/// kitchen/stove` is a crash.
/// @returns the fault, of an ecology as the bundle describes it, or why it is none
[[nodiscard]] std::variant<config::fault, std::string>
fault_of(const bundle& x, std::string_view sentence, const config::extensions& known);

/// Whether it is one of a change.
[[nodiscard]] bool is_change_sentence(std::string_view sentence);

/// The [[fault]] or [[change]] of a sentence that fault_of() takes, as a file has it. @param at
/// `"12s"`
[[nodiscard]] std::string table_of(std::string_view sentence, const std::string& at);

} // namespace rubicon::deploy
