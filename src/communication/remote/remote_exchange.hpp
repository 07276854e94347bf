// What the parts of a program in an actor of its own share: commands to its node, events for the
// program, and what it knows of its node.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "communication/interface.hpp"
#include "communication/process.hpp"
#include "communication/remote_messages.hpp"
#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::communication {

struct remote_counters {
  std::uint64_t refused = 0;     ///< commands that returned FAIL
  std::uint64_t before_join = 0; ///< of them, for want of a join (MCK-16)
  std::uint64_t no_room = 0;     ///< of them, because too many were in flight
  std::uint64_t bad_reads = 0;   ///< read_input() without a value
};
RUBICON_FIELDS(remote_counters, refused, before_join, no_room, bad_reads);

/// Numbers of its own that a program has for streams, or for synaptic channels.
template <class Row>
class numbered_rows {
public:
  static constexpr std::uint16_t number_max = 32767;

  /// nullptr: there is none.
  [[nodiscard]] Row* find(int number) { return find_in(rows_, number); }
  [[nodiscard]] const Row* find(int number) const { return find_in(rows_, number); }
  /// @pre fewer than number_max rows
  std::uint16_t add(Row row) {
    do
      last_ = static_cast<std::uint16_t>(last_ % number_max + 1);
    while (rows_.contains(last_));
    rows_.emplace(last_, std::move(row));
    return last_;
  }
  void erase(std::uint16_t number) { rows_.erase(number); }

  [[nodiscard]] const std::map<std::uint16_t, Row>& all() const { return rows_; }

private:
  template <class Rows>
  [[nodiscard]] static auto find_in(Rows& rows, int number) -> decltype(&rows.begin()->second) {
    const bool is_one = number > 0 && number <= number_max;
    const auto found = rows.find(is_one ? static_cast<std::uint16_t>(number) : std::uint16_t{});
    return found == rows.end() ? nullptr : &found->second;
  }

  std::map<std::uint16_t, Row> rows_;
  std::uint16_t last_ = 0;
};

/// Commands wait here until they are sent, events until the state of all parts is complete. Each
/// side acknowledges what it has handled of the other.
class remote_exchange {
public:
  using event = std::function<void(communication_events&)>;

  /// @param commands_max that the node has not taken; closing and disposing do not count
  remote_exchange(remote::limits node, std::size_t commands_max)
      : node_(node), commands_max_(commands_max) {}

  [[nodiscard]] const remote::limits& node() const { return node_; }
  void set_program(communication_events* x) { program_ = x; } ///< nullptr: it has left

  void set_time(instant now) { now_ = now; }
  [[nodiscard]] instant now() const { return now_; }
  void set_address(std::optional<mote_address> x) { self_ = x; }
  [[nodiscard]] const std::optional<mote_address>& address() const { return self_; }

  // Of commands of the program.
  status refuse();               ///< counts one that fails
  [[nodiscard]] bool may_send(); ///< the node has joined; counted if not
  [[nodiscard]] bool has_room(); ///< for one more; counted if not
  void count_bad_read() { ++counters_.bad_reads; }
  void command(remote::command x) { commands_.push_back(std::move(x)); }
  /// The one that leaves last so far; nullptr: there is none.
  [[nodiscard]] remote::command* last_command() {
    return commands_.empty() ? nullptr : &commands_.back();
  }

  // Of events of the node.
  void notify(event x) { events_.push_back(std::move(x)); }
  void clear_events() { events_.clear(); }
  /// Delivers all to the program, also those that it causes from within one.
  void dispatch();

  /// @param taken commands, by the node @param count of the events that have come
  void on_batch(std::uint64_t taken, std::size_t count);
  /// Nothing: there is neither a command nor an acknowledgement to send.
  [[nodiscard]] std::optional<remote::commands_batch> take_batch();

  [[nodiscard]] std::size_t commands_in_flight() const; ///< not taken by the node
  [[nodiscard]] const remote_counters& counters() const { return counters_; }

private:
  remote::limits node_;
  std::size_t commands_max_ = 0;
  communication_events* program_ = nullptr;
  instant now_;
  std::optional<mote_address> self_;

  remote::commands commands_;        ///< to be sent
  std::uint64_t commands_sent_ = 0;  ///< so far
  std::uint64_t commands_taken_ = 0; ///< of them, by the node
  std::deque<event> events_;         ///< to be delivered
  bool dispatching_ = false;
  std::uint64_t events_received_ = 0; ///< so far
  std::uint64_t events_acked_ = 0;    ///< of them, acknowledged to the node
  remote_counters counters_;
};

/// With what own_island and own_mote stand for, once the node has joined.
/// @param own stands for own_island; own_island: the node's
[[nodiscard]] mote_address resolved(const remote_exchange& exchange, mote_address x, island_id own);

} // namespace rubicon::communication
