// Messages and files as octets, which a program of the same version reads again.
#pragma once

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "deploy/bundle.hpp"
#include "deploy/messages.hpp"
#include "report/merge.hpp"

namespace rubicon::control {

[[nodiscard]] bytes octets_of(const report::part_report& x);
[[nodiscard]] bytes octets_of(const deploy::bundle& x);

/// bad_value for what octets_of() has not made.
[[nodiscard]] result<report::part_report> part_report_of(byte_view octets);
[[nodiscard]] result<deploy::bundle> bundle_of(byte_view octets);

/// Without the kind of question, which is its index.
[[nodiscard]] bytes octets_of(const deploy::question& x);
[[nodiscard]] bytes octets_of(const deploy::answer& x);

/// @param kind index in deploy::question; bad_value if there is none
[[nodiscard]] result<deploy::question> question_of(std::uint8_t kind, byte_view octets);
[[nodiscard]] result<deploy::answer> answer_of(std::uint8_t kind, byte_view octets);

/// Index in deploy::answer of what answers a question of that kind. @pre there is one
[[nodiscard]] std::uint8_t answer_kind(std::uint8_t question_kind);

} // namespace rubicon::control
