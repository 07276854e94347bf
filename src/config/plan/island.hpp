// The islands of an ecology: their motes and sinks, lines and gateways, and the air around them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/app_config.hpp"
#include "core/address.hpp"
#include "core/shared_list.hpp"
#include "core/time.hpp"
#include "core/tuples/wire_form.hpp"
#include "device/transducer_config.hpp"
#include "device/waypoint.hpp"
#include "firmware/program_config.hpp"
#include "gateway/plain/plain_rule.hpp"
#include "mote/duty_config.hpp"
#include "radio/parameters.hpp"
#include "serial/cable/backbone_config.hpp"
#include "serial/cable/line_config.hpp"
#include "smepp/member_config.hpp"
#include "tinyos/program_config.hpp"
#include "traffic/flow_config.hpp"

namespace rubicon::config {

using sampler_app = apps::sampler_config;
using actuator_app = apps::actuator_config;
using messenger_app = apps::messenger_config;
using listener_app = apps::listener_config;
using member_app = smepp::member_config;

/// A program in an actor of its own, beside its mote's.
struct separate_app {
  apps::app_config program;
};

using mote_app =
    std::variant<sampler_app, actuator_app, messenger_app, listener_app, apps::app_config,
                 traffic::sender_config, traffic::relay_config, traffic::receiver_config,
                 separate_app, member_app, tinyos::program_config, firmware::program_config>;

/// In between it moves in a straight line, after the last it stays.
using device::waypoint;

struct mote_description {
  // Compiled once: they are large.
  mote_description();
  ~mote_description();
  mote_description(const mote_description&);
  mote_description& operator=(const mote_description&);
  mote_description(mote_description&&) noexcept;
  mote_description& operator=(mote_description&&) noexcept;

  mote_id id;
  std::string name;                          ///< unique in its island
  std::uint32_t type = 0;                    ///< signature reported at join (PXY-13)
  std::string type_name;                     ///< the [mote_type.NAME] it came from; empty if none
  const radio::platform* platform = nullptr; ///< never nullptr in a valid description
  position place;
  std::vector<waypoint> path;         ///< ascending by time; empty: it stays at `place`
  duration step = 1s;                 ///< how often its position is updated while it moves
  bool stays_when_flat = false;       ///< with its battery its walk ends, too
  std::optional<double> transmit_dbm; ///< unset: the platform's full power
  std::optional<double> battery_mah;  ///< unset: the platform's
  radio::access_parameters access;
  std::optional<std::uint8_t> channel;             ///< of its radio; unset: its island's
  std::optional<serial::backbone_config> backbone; ///< set: it is a further sink of its island
  shared_list<device::transducer_config> transducers;
  shared_list<device::actuator_config> actuators;
  shared_list<mote_app> apps;
};

struct sink_description {
  mote_id id = default_sink;
  const radio::platform* platform = nullptr;
  position place;
  std::optional<double> transmit_dbm; ///< unset: the platform's full power
  bool promiscuous = false;           ///< hears frames of other islands and for other motes
  radio::access_parameters access;
  std::vector<mote_app> apps; ///< sender, relay and receiver only
};

/// How much of a mote's communication layer runs.
enum class stack : std::uint8_t {
  full,  ///< joins its island, whose sink has a serial line and a gateway
  mac,   ///< radio and medium access only, for measuring: no joining, no serial line, no gateway
  plain, ///< plain programs of TinyOS: no joining; the sink is a BaseStation at a serial line
};

/// Whether an island with it has a serial line and, there or elsewhere, a gateway.
[[nodiscard]] constexpr bool has_line(stack x) {
  return x != stack::mac;
}

/// A further gateway of an island, at a further serial line of its sink (GW-14).
struct alias_description {
  peer_id id;       ///< addresses the island too: 1..254
  std::string name; ///< PEIS name; default NAME-gateway-2, NAME-gateway-3, ...
  std::vector<std::string> links;
  serial::line_config serial;
};

inline constexpr std::size_t aliases_max = 3; ///< of one island: a sink has few serial ports

/// A line to a real base station, beside the cable of an island's simulated sink.
struct real_line_description {
  serial::line_config serial; ///< `baud` and `buffer` of it
  serial::outside_config outside;
  gateway::address_range motes;                       ///< those behind it
  std::vector<std::pair<mote_id, std::string>> names; ///< that the file gives some of them

  [[nodiscard]] bool is_there() const { return outside.has_sink(); }
};

struct island_description {
  // Compiled once: they are large.
  island_description();
  ~island_description();
  island_description(const island_description&);
  island_description& operator=(const island_description&);
  island_description(island_description&&) noexcept;
  island_description& operator=(island_description&&) noexcept;

  island_id id; ///< also the PEIS id of its gateway (ADR-02)
  std::string name;
  std::string host; ///< empty: wherever the run is started
  config::stack stack = stack::full;
  std::uint8_t channel = radio::default_channel; ///< of the sink's radio, and of most motes'
  sink_description sink;
  serial::line_config serial;
  serial::outside_config outside;         ///< what one of its ends is in truth
  serial::export_config exported;         ///< to programs of TinyOS
  std::string gateway_name;               ///< PEIS name of the gateway; default NAME-gateway
  std::vector<std::string> gateway_links; ///< names of peers or gateways it connects to
  wire_form gateway_wire = wire_form::segment;
  std::vector<apps::app_config> gateway_apps;
  real_line_description real;             ///< if it is_there()
  std::vector<gateway::plain_rule> plain; ///< of an island with a real sink, or a real line
  std::vector<alias_description> aliases; ///< in the order in which they take over
  duration keep_alive = 10s;              ///< a silent mote is gone after this (DIS-06); motes that
                                          ///< report more rarely get three of their periods
  mote::duty_config duty;                 ///< of its motes' radios; or
  radio::listening_config listening;      ///< of its motes' radios, and what its sink knows of it
  double crystal_ppm = 40;                ///< each mote's clock is off by up to this, drawn,
  double crystal_wander_ppm = 0;          ///< and this more or less as temperature changes,
  duration crystal_wander_period = 24h;   ///< in such a period
  std::vector<mote_description> motes;
};

/// Whether the sink may be one that knows nothing of members: what is behind it is known by what it
/// sends.
[[nodiscard]] bool has_plain_sink(const island_description& x);

/// Of its radio, in that island.
[[nodiscard]] std::uint8_t channel_of(const island_description& island,
                                      const mote_description& mote);

/// How long a mote of the island may be silent that does not report more rarely: who sleeps is
/// heard once in a period, and one frame lost is no departure.
[[nodiscard]] duration silence_max(const island_description& x);

/// PEIS ids of all gateways of an island, in the order in which they take over; that of the island
/// first.
[[nodiscard]] std::vector<peer_id> gateways_of(const island_description& x);

/// Islands that share a place and a radio channel.
struct air_description {
  std::string name;
  std::vector<island_id> islands;
};

} // namespace rubicon::config
