// Connectionless messages of a node's programs (D1.1 5.3.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "communication/outputs_wanted.hpp"
#include "communication/ports/local_node.hpp"
#include "communication/ports/program_list.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "transport/messenger.hpp"

namespace rubicon::communication {

/// Which program gets messages of which AM type, and which program has sent what. Messages of the
/// gateway that request outputs are for all programs (GW-10).
class message_port {
public:
  message_port(local_node& node, program_list& programs, const transport::messenger_config& config,
               random_stream rng);

  // Commands of a program.
  std::optional<std::uint32_t> send(std::size_t program, mote_address to, byte_view octets,
                                    bool reliable, std::uint8_t am_type);
  status provide(std::size_t program, std::uint8_t am_type);
  void hold(std::size_t program, std::uint8_t am_type);
  void release(std::size_t program, std::uint8_t am_type);

  /// It gets messages of all types that no other program provides.
  void provide_rest(std::size_t program) { rest_owner_ = program; }

  /// Notifies a new program of the outputs that the gateway has requested, if any.
  void attach(std::size_t program);
  void leave(std::size_t program);

  void on_segment(island_id source, byte_view octets);
  void on_joined(island_id island) { messages_.join(island); }
  void on_left(); ///< reliable sends fail
  void on_time();
  [[nodiscard]] std::optional<instant> deadline() const { return messages_.deadline(); }

  void forget_incarnation(mote_address x) { messages_.forget_incarnation(x); }
  void set_answer_slack(duration x) { messages_.set_answer_slack(x); }

  [[nodiscard]] const transport::messenger& core() const { return messages_; }
  [[nodiscard]] std::size_t footprint() const {
    return messages_.footprint() + 1 + outputs_wanted_max * 6;
  }

private:
  /// A reliable send whose ack() has not been reported to its program.
  struct pending_send {
    transport::ticket number = 0;
    std::optional<bool> acked; ///< nothing: it has not ended
  };

  [[nodiscard]] bool owns(std::size_t program, std::uint8_t am_type) const;
  void apply(transport::outputs todo);
  void on_received(transport::received& x);
  void on_outcome(const transport::outcome& x);
  void on_outputs_wanted(const transport::received& x);
  void notify_outputs_wanted(std::size_t program);

  local_node& node_;
  program_list& programs_;
  transport::messenger messages_;
  small_map<std::uint8_t, std::size_t> owners_;               ///< of AM types
  std::optional<std::size_t> rest_owner_;                     ///< of all others
  small_map<transport::ticket, std::size_t> senders_;         ///< of reliable sends in flight
  small_map<std::size_t, std::vector<pending_send>> pending_; ///< of each program, in order
  std::uint32_t last_number_ = 0;
  std::vector<output_wanted> outputs_wanted_; ///< by the gateway (GW-10)
};

} // namespace rubicon::communication
