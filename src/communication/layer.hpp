// The Communication Layer of one node above Network: Transport, streams, synaptic channels, and the
// programs that use them (GEN-08, D1.1 5.1). The same on a mote and on a PC; what differs is below
// it, and is its owner's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "communication/direct_process.hpp"
#include "communication/interface.hpp"
#include "communication/ports/channel_port.hpp"
#include "communication/ports/device_port.hpp"
#include "communication/ports/layer_output.hpp"
#include "communication/ports/layer_ports.hpp"
#include "communication/ports/local_node.hpp"
#include "communication/ports/message_port.hpp"
#include "communication/ports/program_list.hpp"
#include "communication/ports/stream_port.hpp"
#include "communication/ports/synaptic_port.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "transport/messenger.hpp"

namespace rubicon::communication {

/// Hands inputs and commands to the port whose duty they are, and knows which island the node has
/// joined. Programs are called back from within the on_ functions, of this and of its ports, and
/// may give commands then. What all that leads to is fetched by the owner with take_outputs(),
/// after each on_ function and after each command given from outside.
class layer {
public:
  layer(const layer_config& config, random_stream rng);
  ~layer();
  layer(const layer&) = delete; // programs and ports point into it
  layer& operator=(const layer&) = delete;

  /// @param events a program's, which outlives this
  /// @param name for observe(); empty: what it receives is not observed
  [[nodiscard]] interface attach(communication_events& events, std::string name = {});

  /// The program that gets messages of types that no other provides; at most one.
  [[nodiscard]] interface attach_for_rest(communication_events& events);

  /// Called at once for what programs send, and for what those with names receive. Must not give
  /// commands.
  void observe(program_observer observer) { ports_.programs.observe(std::move(observer)); }

  /// Commands given from outside an event happen now.
  void set_time(instant now) { ports_.node.now = now; }
  /// The time that peers share is so much ahead of `now`, since 1970.
  void set_network_ahead(duration x) { ports_.node.network_ahead = x; }

  void on_initialised(bool success, instant now);
  void on_joined(island_id island, instant now); ///< a PC: at once
  void on_left(instant now);                     ///< reliable sends have failed

  /// Of the island whose gateway this node is: at first, and after each restart (MCK-15).
  void on_mote_joined(mote_id mote, byte_view description, instant now);
  void forget_incarnation(mote_address x) { ports_.messages.forget_incarnation(x); }

  /// A packet with the header of D1.1 5.4 for this node.
  void on_packet(island_id source, std::uint16_t channel, byte_view body, instant now);

  /// Answers take so much longer from now on, as radios of this island sleep.
  void set_answer_slack(duration x);

  void on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] layer_outputs take_outputs();

  // What answers outputs, and what is below streams and synaptic channels.
  [[nodiscard]] channel_port& channels() { return ports_.channels; }
  [[nodiscard]] device_port& devices() { return ports_.devices; }
  [[nodiscard]] synaptic_port& vectors() { return ports_.synaptic; }

  [[nodiscard]] const layer_ports& ports() const { return ports_; }
  [[nodiscard]] const layer_counters& counters() const { return ports_.node.counters; }

  /// Octets of all state on a mote with the default tables (SMP-30).
  [[nodiscard]] std::size_t footprint() const;

private:
  std::size_t add_program(communication_events& events, std::string name);

  layer_ports ports_;
  std::vector<std::unique_ptr<direct_process>> processes_; ///< by program; programs point to them
};

} // namespace rubicon::communication
