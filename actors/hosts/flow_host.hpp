// Measuring flows inside an actor that owns a radio. They use the radio directly: no layer of the
// communication stack is between them and the medium access that they measure.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/supervision.hpp"
#include "config/plan/ecology.hpp"
#include "radio/frame.hpp"
#include "traffic/program.hpp"

namespace rubicon {

/// Whether a frame is for this mote; a promiscuous radio hands over others too (RTG-06).
[[nodiscard]] inline bool is_for(const radio::frame& x, const mote_address& mote) {
  return x.pan == mote.island.value &&
         (x.destination == mote.mote || x.destination == broadcast_mote);
}

class flow_host {
public:
  static constexpr std::uint8_t timer_number = 1;

  template <class Self>
  void start(Self self, const std::vector<config::mote_app>& apps, mote_address address,
             radio::radio_index radio, air_actor air, random_stream rng) {
    const auto config = config_of(apps);
    if (config.empty())
      return;
    flows_ =
        std::make_unique<running>(radio, std::move(air), traffic::program(config, address, rng));
    perform(self, flows_->program.start(now(self)));
  }

  /// @returns whether the frame was the flows'
  template <class Self>
  bool take(Self self, const radio::frame& x) {
    if (x.am_type != traffic::am_type)
      return false;
    if (flows_)
      perform(self, flows_->program.on_packet(x.source, x.payload, now(self)));
    return true;
  }

  /// Of any request of the radio's owner.
  template <class Self>
  void on_done(Self self, const radio_done& x) {
    if (x.token == 0 || !flows_)
      return; // a request of the stack; counted by the air
    const bool sent = x.status == radio::send_status::sent;
    const auto cause = sent ? radio::to_string(x.last) : radio::to_string(x.status);
    perform(
        self,
        flows_->program.on_done(
            x.token - 1,
            {.sent = sent, .arrived = x.arrived, .cause = cause, .transmissions = x.transmissions},
            now(self)));
  }

  template <class Self>
  void on_timer(Self self, const timer_expired& x) {
    if (flows_ && flows_->wake.accepts(x))
      perform(self, flows_->program.on_time(now(self)));
  }

  [[nodiscard]] bool is_used() const { return flows_ != nullptr; }

  /// The power is lost for good.
  template <class Self>
  void stop(Self self) {
    if (!flows_)
      return;
    flows_->program.stop(now(self));
    flows_->wake.stop();
  }

  template <class Self>
  void report(Self self, const ecology_actor& ecology) const {
    if (!flows_)
      return;
    if (auto parts = flows_->program.parts(now(self)); !parts.empty())
      self->send(ecology, flow_status{std::move(parts)});
  }

private:
  struct running {
    running(radio::radio_index its_radio, air_actor its_air, traffic::program what)
        : radio(its_radio), air(std::move(its_air)), program(std::move(what)) {}

    radio::radio_index radio;
    air_actor air;
    traffic::program program;
    timer wake{timer_number};
  };

  static traffic::program_config config_of(const std::vector<config::mote_app>& apps) {
    traffic::program_config all;
    for (const auto& app : apps) {
      if (const auto* sender = std::get_if<traffic::sender_config>(&app))
        all.senders.push_back(*sender);
      else if (const auto* relay = std::get_if<traffic::relay_config>(&app))
        all.relay = *relay;
      else if (std::holds_alternative<traffic::receiver_config>(app))
        all.receives = true;
    }
    return all;
  }

  /// Requests of flows have tokens from 1; those of the stack have 0.
  template <class Self>
  void perform(Self self, traffic::outputs todo) {
    for (auto& x : todo)
      self->send(flows_->air, radio_send{flows_->radio, x.token + 1, x.next_hop, traffic::am_type,
                                         payload(std::move(x.payload)), x.ack});
    flows_->wake.follow(self, flows_->program.deadline());
  }

  std::unique_ptr<running> flows_; ///< nullptr, as in most: no flows begin, pass or end here
};

} // namespace rubicon
