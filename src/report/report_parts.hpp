// What the sections of the report for a person share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "report/print/report_page.hpp"
#include "report/report.hpp"

namespace rubicon::report {

inline constexpr std::size_t rows_max = 20; ///< of islands, flows, peers, proxies and actuations
inline constexpr std::size_t motes_listed_max = 12; ///< one by one; of more, those that stand out

/// `loss 12, collision 3`, the most frequent first; causes that never happened are left out.
[[nodiscard]] std::string causes(const cause_counts& x);

/// Nobody missed copies for another radio, repeats of a frame already received, and what a radio
/// without power could not hear.
[[nodiscard]] bool is_missed(std::string_view cause);

/// Copies that somebody missed.
[[nodiscard]] cause_counts really_lost(const radio_report& x);

/// Share of its battery's charge.
[[nodiscard]] double left_of(const mote_report& x);

/// How long a mote's battery lasts if it goes on as it did; why it is off if it is.
[[nodiscard]] std::string projected_life(const mote_report& x);

/// The share in percent; `–` of nothing.
[[nodiscard]] std::string share_of(std::uint64_t part, std::uint64_t whole);

/// What became of messages and frames of each island.
void add_islands(report_page& page, const run_report& x);

/// How packets reach the sinks, and how exact clocks are; nothing without any.
void add_network(report_page& page, const run_report& x);

/// Motes of SMEPP groups; nothing without any.
void add_groups(report_page& page, const run_report& x);

/// Packets of the measuring apps; nothing without any.
void add_flows(report_page& page, const run_report& x);

/// Figures of programs that use the Mockup interface; nothing without any.
void add_programs(report_page& page, const run_report& x);

/// What became of the messages of each mote, the worst first; nothing without any.
void add_deliveries(report_page& page, const run_report& x);
void add_losses(report_page& page, const run_report& x);

/// Streams between programs; nothing without any.
void add_streams(report_page& page, const run_report& x);

/// What the file expects, and how it has come out; nothing without any.
void add_expectations(report_page& page, const run_report& x);

} // namespace rubicon::report
