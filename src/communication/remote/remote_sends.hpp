// Messages of a program in an actor of its own, on its side.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>

#include "communication/process.hpp"
#include "communication/remote/remote_exchange.hpp"
#include "communication/remote_messages.hpp"

namespace rubicon::communication {

class remote_sends final : public message_commands {
public:
  explicit remote_sends(remote_exchange& exchange) : exchange_(exchange) {}

  std::optional<std::uint32_t> send(mote_address to, byte_view octets, bool reliable,
                                    std::uint8_t am_type) override;
  status provide(std::uint8_t am_type) override;
  void hold(std::uint8_t am_type) override;
  void release(std::uint8_t am_type) override;

  /// Holds are sent to the node last, so that these commands need no room.
  void command_holds();

  void apply(const remote::send_ended& x);
  void apply(const remote::message_received& x);
  void apply(const remote::type_refused& x);

private:
  struct pending_send {
    std::uint32_t number = 0;
    std::optional<bool> acked; ///< nothing: it has not ended
  };

  remote_exchange& exchange_;
  std::deque<pending_send> sends_; ///< ack() keeps their order
  std::uint32_t last_number_ = 0;
  std::set<std::uint8_t> types_;
  std::set<std::uint8_t> held_;         ///< of these, by the program
  std::set<std::uint8_t> held_at_node_; ///< as sent to the node
};

} // namespace rubicon::communication
