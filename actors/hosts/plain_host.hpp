// Plain programs of TinyOS on a mote: they have its radio, its transducers and its clock, and no
// layer between.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "config/plan/ecology.hpp"
#include "core/numbers/random.hpp"
#include "core/shared_list.hpp"
#include "device/transducer.hpp"
#include "mote/crystal.hpp"
#include "radio/frame.hpp"
#include "report/report.hpp"
#include "tinyos/program.hpp"

namespace rubicon {

/// Set in the token of what plain programs send; those of others (network_radio.hpp,
/// smepp_shell.hpp) and of flows do not have it.
inline constexpr std::uint64_t plain_token = 1ULL << 61U;

/// Whose programs they are, and what they read.
struct plain_host_config {
  mote_id self;
  radio::radio_index radio;
  air_actor air;
  mote::crystal crystal;
  shared_list<device::transducer_config> transducers;
  std::uint64_t transducer_seed = 0;
  position place;
};

class plain_host {
public:
  static constexpr std::uint8_t timer_number = 6;

  /// @param rng decides when each begins, within its first interval
  plain_host(plain_host_config config, const std::vector<tinyos::program_config>& programs,
             random_stream rng, instant now);

  template <class Self>
  void start(Self self) {
    follow(self);
  }

  /// The radio has delivered a frame.
  template <class Self>
  void take(Self self, const radio::frame& x) {
    for (auto& each : programs_)
      each.runs.on_packet(x.am_type, x.payload, own(now(self)));
    follow(self);
  }

  /// @returns whether the request was of these programs
  [[nodiscard]] bool on_done(const radio_done& x);

  template <class Self>
  void on_timer(Self self, const timer_expired& x) {
    if (!wake_.accepts(x))
      return;
    for (std::size_t i = 0; i < programs_.size(); ++i) {
      auto& each = programs_[i];
      auto packet = each.runs.on_time(own(now(self)),
                                      [&] { return read(each.config.transducer, now(self)); });
      if (packet)
        self->send(config_.air,
                   radio_send{config_.radio, plain_token | i, broadcast_mote, packet->am_type,
                              payload(std::move(packet->payload)), false});
    }
    follow(self);
  }

  /// The power is lost for good.
  void stop() {
    is_stopped_ = true;
    wake_.stop();
  }

  void move(position place) { config_.place = place; }

  /// What they have counted, by the program's name.
  [[nodiscard]] report::cause_counts counted() const;

private:
  struct running {
    tinyos::program_config config;
    tinyos::program runs;
  };

  template <class Self>
  void follow(Self self) {
    if (is_stopped_)
      return;
    std::optional<instant> due;
    for (const auto& each : programs_)
      due = earliest(due, std::optional(each.runs.deadline()));
    wake_.follow(self, config_.crystal.real(*due));
  }

  [[nodiscard]] instant own(instant real) const { return config_.crystal.own(real); }
  [[nodiscard]] std::uint16_t read(const std::optional<device::quantity>& kind, instant now);

  plain_host_config config_;
  random_stream rng_;
  std::vector<running> programs_; ///< never empty
  timer wake_{timer_number};
  bool is_stopped_ = false;
};

/// The plain programs among a mote's.
[[nodiscard]] std::vector<tinyos::program_config>
plain_programs_among(const std::vector<config::mote_app>& apps);

} // namespace rubicon
