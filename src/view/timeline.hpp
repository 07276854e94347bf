// All that the live page can be asked about a run, at any moment of it: what the run has reported
// so far, within bounds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "explain/traces.hpp"
#include "report/history.hpp"
#include "report/report.hpp"
#include "view/message_list.hpp"

namespace rubicon::view {

struct listed_event {
  instant at;
  std::string who;
  std::string what;
  std::string_view kind = "event"; ///< `event`, `fault`, `violation` or `expectation`
};

/// A value that a tuple had from a moment on: setting it to the same again changes nothing.
struct tuple_value {
  instant since;
  std::string value;
  bool deleted = false;
};

struct run_state {
  instant now;
  instant end;
  bool running = false;
  std::uint64_t events = 0; ///< messages delivered to actors so far
  double speed = 0;         ///< ecology seconds per real second
};

/// Written by the run, read by the web server, from any threads: what is read is shared, not
/// copied, so that the run waits only briefly. Values of tuples, of which there
/// are many, are only queued by the run; the next reader puts them in order: flush().
///
/// At samples_max every second sample is dropped; the newest stays. Likewise values of tuples; of
/// events the oldest are dropped.
class timeline {
public:
  using sample = std::shared_ptr<const report::run_sample>;
  using tuple_key = std::pair<std::string, std::string>; ///< owner and key

  static constexpr std::size_t samples_max = 400;
  static constexpr std::size_t mote_samples_max = 2'000'000; ///< in all samples
  static constexpr std::size_t events_max = 50'000;
  static constexpr std::size_t tuples_max = 20'000;
  static constexpr std::size_t values_max = 400'000; ///< of all tuples
  static constexpr std::size_t value_octets_max = 512;
  static constexpr std::size_t pending_max = 65'536; ///< more are put in order by the run itself

  void add(report::run_sample x);
  void add(const report::tuple_write& x);
  void add(listed_event x);
  void set(run_state x);
  /// From now on these messages can be explained.
  void set(std::shared_ptr<const message_list> x);
  /// Why no message can be explained at this time, or why some cannot.
  void set_why_no_messages(std::string x);
  /// Called for each request for messages, on its thread: the list may be out of date.
  void set_on_messages(std::function<void()> x);

  /// Puts the queued values in order, on the calling thread; reading does so too.
  void flush() const;

  [[nodiscard]] run_state state() const;
  [[nodiscard]] std::size_t samples() const;
  [[nodiscard]] sample newest() const; ///< nullptr: none yet
  /// The newest that is not later; nullptr: none.
  [[nodiscard]] sample at(instant x) const;
  [[nodiscard]] std::vector<sample> all_samples() const;

  /// Events from this number on, which counts all that there ever were.
  struct events_then {
    std::vector<listed_event> events;
    std::uint64_t next = 0; ///< number of the first that is not among them
  };
  [[nodiscard]] events_then events_from(std::uint64_t number) const;
  [[nodiscard]] std::uint64_t events() const;
  [[nodiscard]] std::optional<listed_event> event_after(instant x) const;

  struct tuples_then {
    /// Those that there were, ascending by owner and key.
    std::vector<std::pair<tuple_key, tuple_value>> tuples;
    std::uint64_t left_out = 0; ///< writes of tuples beyond tuples_max
  };
  [[nodiscard]] tuples_then tuples_at(instant x) const;
  [[nodiscard]] std::vector<tuple_value> values_of(const tuple_key& x) const;

  [[nodiscard]] std::shared_ptr<const message_list> messages() const;
  [[nodiscard]] std::string why_no_messages() const;

private:
  struct tuple_history {
    tuple_key key;
    std::vector<tuple_value> values; ///< ascending by time
  };
  /// Values as they come, one behind the other: the run allocates nothing for each.
  struct pending_values {
    struct value {
      instant at;
      std::uint32_t owner_size = 0; ///< octets of `text`, as all sizes
      std::uint32_t key_size = 0;
      std::uint32_t size = 0;
      bool deleted = false;
    };
    std::vector<value> all;
    std::string text; ///< of each its owner, a NUL, its key and the value
  };
  struct tuple_table {
    std::unordered_map<std::string, tuple_history> tuples; ///< by owner, a NUL, and key
    std::size_t values = 0;                                ///< of all
    std::uint64_t left_out = 0;                            ///< writes of tuples beyond tuples_max
    std::string name;                                      ///< buffer for look-ups

    void put(const pending_values::value& x, std::string_view text);
    void put(tuple_history& to, const pending_values::value& x, std::string_view text);
    void thin();
  };

  void thin_samples();

  mutable std::mutex pending_lock_; ///< of the next one
  mutable pending_values pending_;
  mutable std::mutex table_lock_; ///< of the next two; taken before pending_lock_, if both are
  mutable pending_values flushing_;
  mutable tuple_table table_;

  mutable std::mutex lock_; ///< of all the others
  run_state state_;
  std::vector<sample> samples_; ///< ascending by time
  sample newest_;
  std::uint64_t sample_stride_ = 1;
  std::uint64_t samples_added_ = 0;
  std::vector<listed_event> events_; ///< as they were reported
  std::uint64_t events_forgotten_ = 0;
  std::shared_ptr<const message_list> messages_;
  std::string why_no_messages_;
  std::function<void()> on_messages_;
};

} // namespace rubicon::view
