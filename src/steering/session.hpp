// A run that another program steers: each request in its line, the answer to each
// (docs/steering.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "report/history.hpp"
#include "report/report.hpp"
#include "steering/request.hpp"

namespace rubicon::steering {

/// What a session does with a run.
struct run_ports {
  /// Lets time go on up to then. @returns how far it has come
  std::function<instant(instant until)> run_until;
  std::function<std::optional<std::string>(const get_request&)> tuple;
  /// @returns why it cannot be done; empty: done
  std::function<std::string(const set_request&)> set_tuple;
  /// Lets it happen at that moment, which is not over. @returns as set_tuple
  std::function<std::string(const std::string& words, instant at)> fault;
  /// As a program of the mote sends. @param number in events of its outcome @returns as set_tuple
  std::function<std::string(const send_request&, std::uint32_t number)> send;
  /// What fault() has taken, as a table of a file. @param at `10.5s`
  std::function<std::string(const std::string& words, const std::string& at)> table;
  std::function<report::run_sample()> look;
  std::function<std::string()> report; ///< so far, as a JSON object
  std::function<std::string()> finish; ///< runs it to its end; the report likewise
};

/// What the program that steers has to know first.
struct run_facts {
  std::string name; ///< of the ecology
  std::uint64_t seed = 0;
  duration length{};
  std::vector<std::string> peers;
  std::map<mote_address, std::string> motes; ///< their names
};

class session {
public:
  static constexpr std::size_t news_max = 10'000;     ///< of events and of tuples, in an answer
  static constexpr std::size_t patterns_max = 256;    ///< of subscriptions
  static constexpr std::size_t actions_max = 100'000; ///< that are recorded

  session(run_facts facts, run_ports run) : facts_(std::move(facts)), run_(std::move(run)) {}

  /// The first line to the other program, before any request.
  [[nodiscard]] std::string greeting() const;

  /// @returns the answer, without the end of its line
  [[nodiscard]] std::string on_line(std::string_view line);

  void on_event(const report::logged_event& x);
  void on_tuple(const report::tuple_write& x);

  /// finish() has been requested: there will be no other answer.
  [[nodiscard]] bool is_finished() const { return finished_; }

  /// What was done, as lines that do it again: a file for `rubicon run FILE --steer LINES`.
  [[nodiscard]] std::string lines() const;

  /// The same as tables that a file may end with; comments are what no file can plan.
  [[nodiscard]] std::string tables() const;

private:
  class answerer;

  /// Something that was done to the run.
  struct action {
    instant at; ///< when it was requested
    request what;
    instant happens; ///< after that
  };

  run_facts facts_;
  run_ports run_;
  instant now_;
  instant fault_at_;       ///< of the last one
  std::uint32_t sent_ = 0; ///< messages
  bool finished_ = false;
  bool wants_events_ = false;
  std::vector<tuples_request> patterns_;
  std::deque<report::logged_event> events_;
  std::deque<report::tuple_write> tuples_;
  std::uint64_t missed_ = 0; ///< events and tuples since the last answer, the oldest ones
  std::vector<action> actions_;
};

} // namespace rubicon::steering
