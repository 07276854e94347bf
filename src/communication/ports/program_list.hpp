// The programs of one node: who is attached, the events that they have not received yet, and what
// an observer of the node learns of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "communication/interface.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"

namespace rubicon::communication {

/// What a program has done or received, for whoever observes the node. Views are valid during the
/// call only.
struct program_note {
  enum class kind : std::uint8_t { sent, send_ended, received, actuator_changed };

  kind what = kind::sent;
  std::string_view program = {};
  std::uint32_t number = 0; ///< of a send; 0: refused
  mote_address other = {};  ///< destination, or source
  std::uint8_t am_type = 0;
  byte_view octets = {};
  std::string_view actuator = {};
  std::uint8_t state = 0; ///< of the actuator
  bool yes = false;       ///< sent: reliable; send_ended: acknowledged; actuator_changed: obeyed
};

using program_observer = std::function<void(const program_note&)>;

class program_list {
public:
  /// An event for a program, once the command or input that led to it is over.
  using event = std::function<void(communication_events&)>;

  /// @param events a program's, which outlives this or is detached
  /// @param name for the observer; empty: what it receives is not observed
  /// @returns its number, which another has after it is detached
  std::size_t attach(communication_events& events, std::string name);

  /// It gets no more events.
  void detach(std::size_t program);

  /// Numbers below this are programs, or were.
  [[nodiscard]] std::size_t size() const { return programs_.size(); }

  [[nodiscard]] bool wants_ticks(std::size_t program) const;
  [[nodiscard]] bool any_wants_ticks() const;

  void notify(std::size_t program, event x);
  void notify_all(const event& x);

  /// Notifies the program that `owners` has for `key`, if any.
  template <class Owners>
  void notify_owner(const Owners& owners, typename Owners::key_type key, event x) {
    const auto owner = owners.find(key);
    if (owner != owners.end())
      notify(owner->second, std::move(x));
  }

  /// Delivers all events, also those that programs cause from within one.
  void dispatch();

  void observe(program_observer observer) { observer_ = std::move(observer); }
  void note(std::size_t program, program_note x) const;

private:
  struct entry {
    communication_events* events = nullptr; ///< nullptr: detached
    std::string name;                       ///< empty: not observed
  };

  std::vector<entry> programs_;
  std::vector<std::pair<std::size_t, event>> events_;
  bool dispatching_ = false;
  program_observer observer_;
};

/// The keys that `owners` has for a program.
template <class Owners>
[[nodiscard]] std::vector<typename Owners::key_type> owned(const Owners& owners,
                                                           std::size_t program) {
  std::vector<typename Owners::key_type> found;
  for (const auto& [key, owner] : owners) {
    if (owner == program)
      found.push_back(key);
  }
  return found;
}

} // namespace rubicon::communication
