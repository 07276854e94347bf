// Whether a run has come out as its file expects ([[expect]]). Receives what happens as it happens;
// the rest it finds in the finished report. Knows neither actors nor clocks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/plan/expectation.hpp"
#include "core/time.hpp"
#include "report/expect/expectation_judge.hpp"
#include "report/expect/expectation_watch.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// `delivery kitchen >= 99%`, `"a.state" = "on" within 5 s of "b.door" = "open"`
[[nodiscard]] std::string to_text(const config::expectation& x);

/// Judges. An expectation about what never was - no message, no sample, no such tuple - is not met.
class expectations {
public:
  expectations() = default;
  /// @param length of the run
  expectations(const std::vector<config::expectation>& all, duration length);

  [[nodiscard]] bool empty() const { return all_.empty(); }
  [[nodiscard]] bool watches_tuples() const { return watches_tuples_; }

  /// Some owner's tuple has a new value. What comes before something else that was received is
  /// taken as of the same time.
  void on_tuple(std::string_view key, std::string_view text, instant now);
  void on_tuple_gone(std::string_view key, instant now);

  /// A mote is listed by its gateway; again, if it was before.
  void on_joined(const mote_address& mote, instant now);

  /// When clocks or programs are to be asked next; nothing: they are not.
  [[nodiscard]] std::optional<instant> next_sample() const;
  /// They are asked now: the time of the next one moves on.
  void on_sample(instant now);

  /// How far a mote's island time is from its sink's clock.
  void on_clock(const mote_address& mote, const std::string& name, duration error, instant now);

  /// What one of a node's programs has missed so far, in all its lives.
  void on_vectors(const std::string& node, std::uint32_t program, std::uint64_t missed,
                  instant now);

  /// A line of the event log, whether it stays there or not.
  void on_event(const logged_event& x);

  /// The judgements, in the order of the file. @param x complete, but for them
  [[nodiscard]] std::vector<expectation_report> judge(const run_report& x) const;

private:
  void on_value(std::string_view key, const std::string* text, instant now);

  std::vector<watched_expectation> all_;
  noticed noticed_;
  instant end_;
  bool watches_tuples_ = false;
};

/// What the invariant of such a violation begins with.
inline constexpr std::string_view expected = "expected: ";

/// An unmet expectation as a violation has it.
[[nodiscard]] violation violation_of(const expectation_report& x);

} // namespace rubicon::report
