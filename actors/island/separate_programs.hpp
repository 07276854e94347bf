// The programs of a node that are in actors of their own (PAR-05), at the node.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "actors/messages/programs.hpp"
#include "communication/program_port.hpp"
#include "core/small_map.hpp"

namespace rubicon {

/// The node is a mote::node or communication::pc; whoever owns it calls its begin() before leave()
/// and on_commands(), its settle() or flush() afterwards, and then send_events().
class separate_programs {
public:
  /// @pre none has its number: leave() was called
  /// @param incarnation how often the node was started before
  template <class Self, class Node>
  void attach(Self* self, Node& node, const attach_program& x, std::uint32_t incarnation) {
    self->monitor(x.program);
    auto& added = all_[x.number];
    added.actor = x.program;
    added.port = std::make_unique<communication::program_port>(node);
    self->send(added.actor, program_attached{added.port->limits(), incarnation});
  }

  [[nodiscard]] bool contains(std::uint32_t number) const { return all_.contains(number); }

  [[nodiscard]] std::optional<std::uint32_t> number_of(const caf::actor_addr& program) const {
    const auto found = std::ranges::find_if(
        all_, [&program](const auto& x) { return x.second.actor.address() == program; });
    return found == all_.end() ? std::nullopt : std::optional(found->first);
  }

  /// @pre contains() its number
  void on_commands(const program_commands& x) { all_.at(x.number).port->on_commands(x.batch); }

  /// What it has open is closed. @pre contains(number)
  void leave(std::uint32_t number) {
    const auto leaving = all_.extract(number);
    leaving->port->leave();
    gone_ += leaving->port->counters();
  }

  /// Of all that were ever attached.
  [[nodiscard]] communication::program_port_counters counters() const {
    auto sum = gone_;
    for (const auto& [number, x] : all_)
      sum += x.port->counters();
    return sum;
  }

  template <class Self>
  void send_events(Self* self) {
    for (auto& [number, x] : all_)
      if (auto events = x.port->take_events())
        self->send(x.actor, program_events{*std::move(events)});
  }

  /// The node has stopped for good.
  template <class Self>
  void send_detached(Self* self) const {
    for (const auto& [number, x] : all_)
      self->send(x.actor, program_detached{});
  }

private:
  struct attached {
    program_client_actor actor;
    std::unique_ptr<communication::program_port> port;
  };

  small_map<std::uint32_t, attached> all_; ///< by their numbers
  communication::program_port_counters gone_;
};

} // namespace rubicon
