// The one typed description of an ecology. load() in config/load.hpp makes it from TOML; whoever
// holds one may rely on it being valid: ids in range and unique, every reference resolved.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/app_config.hpp"
#include "config/plan/change.hpp"
#include "config/plan/expectation.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/shared_list.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"
#include "core/tuples/wire_form.hpp"
#include "device/transducer_config.hpp"
#include "device/waypoint.hpp"
#include "gateway/plain/plain_rule.hpp"
#include "goal/pursuer_config.hpp"
#include "mote/duty_config.hpp"
#include "peis/wire/link_url.hpp"
#include "peisinit/component.hpp"
#include "proxy/classes/proxy_class.hpp"
#include "proxy/rules/rules_config.hpp"
#include "radio/parameters.hpp"
#include "rfid/reader_config.hpp"
#include "serial/cable/line_config.hpp"
#include "smepp/member_config.hpp"
#include "tinyos/program_config.hpp"
#include "traffic/flow_config.hpp"
#include "translate/translation.hpp"

namespace rubicon::config {

enum class run_mode : std::uint8_t { virtual_time, wall };

/// What a run ends with.
enum class run_end : std::uint8_t {
  duration,
  first_flat_battery, ///< of a mote; at the latest after its duration
};

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
                 separate_app, member_app, tinyos::program_config>;

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
  std::optional<std::uint8_t> channel; ///< of its radio; unset: its island's
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

/// A further gateway of an island, at a further serial line of its sink (GW-14, A-49).
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

/// Starts a proxy for every mote whose signature a proxy class claims (PXY-09).
struct proxy_manager_app {
  std::vector<island_id> islands; ///< whose gateways it listens to
  bool objects = false; ///< it also starts those of tagged objects, whichever reader perceives them
};

/// Subscribes to keys of any owner and keeps the newest value of each.
struct collector_app {
  std::vector<std::string> keys; ///< may hold `*` parts
  duration every{}; ///< asked of motes whose output channels the keys name (IF-04); 0: as they like
};

/// Translates tuples into others and keeps the newest values of some (SVC-09).
struct translate_app {
  std::vector<translate::translation> rules; ///< at least one
};

/// Starts, stops and watches the components of its host: the peisinit there (SVC-01).
struct init_app {
  std::vector<peisinit::component> components; ///< names and ids unique
  std::string lock; ///< path of the file that says so in wall time; empty: one of the host
};

using peer_app =
    std::variant<proxy_manager_app, proxy::rules_config, collector_app, rfid::reader_config,
                 goal::pursuer_config, apps::app_config, init_app, translate_app>;

/// Where a peer takes links over real TCP.
struct tcp_listener {
  std::optional<std::uint16_t> port;  ///< unset: the first free one from 8000 on
  std::string address;                ///< IPv4; empty: loopback, with `lan` all
  std::vector<ipv4_network> networks; ///< others are closed at once; empty: nobody is
};

struct peer_description {
  // Compiled once: they are large.
  peer_description();
  ~peer_description();
  peer_description(const peer_description&);
  peer_description& operator=(const peer_description&);
  peer_description(peer_description&&) noexcept;
  peer_description& operator=(peer_description&&) noexcept;

  peer_id id;
  std::string name;
  std::string table; ///< name of several peers of one table, which have numbers; else empty
  std::string host;
  std::vector<std::string> links;     ///< names of peers or gateways; always kept (AUT-01)
  std::vector<std::string> connect;   ///< `tcp://host:port`, `udp://...`, `bt://...`, always kept
  std::optional<tcp_listener> tcp;    ///< wall time only, as are `connect` and `lan`
  bool lan = false;                   ///< meets whoever the computer's real LAN has (A-78)
  bool udp = false;                   ///< has links over UDP too (UDP-01)
  bool leaf = false;                  ///< has no other links than those above (LEA-01)
  bool manager = true;                ///< makes and closes links as it sees fit (CM-12)
  bool discovery = true;              ///< takes part in the announcements of the simulated network
  bool time_master = false;           ///< its clock is everybody's (CLK-06)
  duration clock_offset{};            ///< by which its own clock is ahead of the true time,
  double clock_ppm = 0;               ///< and runs fast
  std::vector<std::string> bluetooth; ///< simulated adapters, which peers of one host share (BT-03)
  std::string adapter;                ///< a real one, in wall time only (BT-01); empty: none
  position place;                     ///< means something if it has adapters
  bool wired = true;             ///< is in the simulated network; false: links over Bluetooth only
  std::vector<peer_id> managers; ///< may stop it by its tuple kernel.do-quit (TUP-22)
  std::vector<peer_app> apps;
  std::optional<peer_id> init; ///< whose component it is: that peer starts and stops it
};

/// Whether it has links over the real network or a real adapter.
[[nodiscard]] bool has_real_links(const peer_description& x);

/// Simulated Bluetooth. Received strength falls with distance as radio::log_distance has it
/// by default, from 0 dBm sent.
struct bluetooth_description {
  double range_m = 10;             ///< of class 2; scans, HELLOs and links reach as far
  std::uint64_t rate_bps = 16'000; ///< of each link, each way (BT-02); 0: unlimited
  duration scan_period = 10s;
  double threshold_dbm = -67; ///< no link is begun with what is weaker (BT-06); reached at 7.9 m
  bool takeover = false;      ///< another peer announces when the one that does has ended (BT-03)
};

/// What has Bluetooth and is no peer.
struct bluetooth_device {
  std::string name;
  peis::bluetooth_address address;
  position place;
};

/// A thing with a passive tag, which readers perceive.
struct tag_description {
  std::string id; ///< lower case
  bytes memory;   ///< its user memory; may be empty
  position place;
  std::vector<waypoint> path; ///< ascending by time; empty: it stays at `place`
};

/// The simulated network between the hosts of peers.
struct peis_description {
  duration delay = 200us;          ///< of a switched LAN [estimate]
  double loss = 0;                 ///< of packages and announcements, each link and way alike
  std::uint64_t bandwidth_bps = 0; ///< of each link, each way; 0: unlimited
  bluetooth_description bluetooth;
};

/// A computer that a part of the ecology runs on. Where a file has any, the first one has what
/// names none.
struct host_description {
  std::string name;
  std::string address;                ///< under which the others reach it
  std::string listen;                 ///< IPv4 address at which it takes links and commands
  std::uint16_t control_port = 4242;  ///< of `rubicon host`
  std::uint16_t peis_port = 4243;     ///< of the PEIS links from other hosts
  std::vector<ipv4_network> networks; ///< from where those may come; empty: from anywhere
};

/// What one host has of an ecology that runs on several.
struct part_description {
  std::string host;
  std::vector<island_description> others;       ///< islands of the other hosts
  std::map<peer_id, std::string> other_peers{}; ///< names of the other hosts' peers
};

/// The mote's battery is flat at that moment.
struct battery_end_fault {
  mote_address mote;
};
/// The mote's next handler throws; it is out of order for a while, then its supervisor starts it
/// again, as one that remembers what is in its flash.
struct crash_fault {
  mote_address mote;
  duration length = 500ms;
  std::string type{};                                     ///< its mote type from its next start on;
                                                          ///< empty: as before
  std::optional<mote_description> becomes = std::nullopt; ///< what it is then
};
/// The same of an island's sink.
struct sink_crash_fault {
  island_id island; ///< any_island: drawn each time
  duration length = 500ms;
};
/// The clock of a mote's crystal is set.
struct crystal_step_fault {
  mote_address mote; ///< any_mote: drawn each time
  duration by{};     ///< negative: back
};
/// The same of an island's sink.
struct sink_step_fault {
  island_id island; ///< any_island: drawn each time
  duration by{};
};
/// Something that is no mote sends bursts of noise.
struct noise_fault {
  island_id island; ///< in the air of this one
  position place;
  double transmit_dbm = 0;
  std::optional<std::uint8_t> channel; ///< unset: all
  double duty = 1;                     ///< share of the time, above 0 up to 1
  duration burst = 10ms;               ///< gaps are drawn between 0 and twice their mean
  duration length = 30s;
};
/// Copies of frames are lost, beside those of [radio].
struct radio_loss_fault {
  double loss = 0;
  std::optional<island_id> island =
      std::nullopt; ///< for radios of this one, or any_island; unset: for all
  duration length = 30s;
};
/// A second mote with the same address appears.
struct mote_double_fault {
  mote_address mote;
  position place;
  std::optional<duration> length =
      std::nullopt; ///< until it is switched off; unset: at the end of the run
};
/// A mote is switched off, carried to another island and switched on there, as a mote of it.
struct move_island_fault {
  mote_address mote;
  island_id to;
  position place;
  duration length = 10s; ///< that it is off
};
/// The cables of an island's sink, or the one to a gateway, are out for a while.
struct unplug_fault {
  island_id island; ///< any_island: one cable, drawn each time
  duration length = 30s;
  std::optional<peer_id> gateway = std::nullopt; ///< at the other end; unset: all of the island's
};

/// A peer's process, its programs included, ends at once. Its links are reset, as an operating
/// system does.
struct kill_fault {
  peer_id peer;                   ///< any_peer: drawn each time, as in the next ones
  std::optional<duration> length; ///< until it is started again; unset: never
};
/// A peer's computer loses its power: nobody is told anything.
struct power_off_fault {
  peer_id peer;
  std::optional<duration> length;
};
/// A peer's process stands still; what comes for it waits.
struct pause_fault {
  peer_id peer;
  duration length = 10s;
};
/// Peers of two different groups cannot hear each other.
struct partition_fault {
  std::vector<std::vector<peer_id>> groups; ///< those in none make one more
  duration length = 30s;
};
/// Packages are lost, beside those of [peis].
struct link_loss_fault {
  double loss = 0;
  std::vector<peer_id> peers; ///< on links between two of them; empty: on all
  duration length = 30s;
};
/// A second peer with the same id appears.
struct duplicate_id_fault {
  peer_id peer;
  std::optional<duration> length; ///< until it ends; unset: at the end of the run
};
/// A peer's clock is set.
struct clock_step_fault {
  peer_id peer;
  duration by{}; ///< negative: back
};

/// A peer's computer is carried to another place; peers of its host go with it.
struct move_fault {
  peer_id peer;
  position to;
};

/// Or a change, which is no fault, but is planned and happens in the same way.
using fault = std::variant<battery_end_fault, crash_fault, unplug_fault, kill_fault,
                           power_off_fault, pause_fault, partition_fault, link_loss_fault,
                           duplicate_id_fault, clock_step_fault, move_fault, sink_crash_fault,
                           crystal_step_fault, sink_step_fault, noise_fault, radio_loss_fault,
                           mote_double_fault, move_island_fault, change>;

/// Stands for a mote, or an island, that is drawn when the fault happens; any_peer for a peer.
inline constexpr mote_address any_mote{{}, broadcast_mote};
inline constexpr island_id any_island{};

/// When a fault happens that happens more than once.
struct fault_times {
  duration every{};        ///< from `from` on; 0: at random moments
  std::uint32_t count = 0; ///< of random moments, uniform from `from` to `until`
  duration from{};
  std::optional<duration> until; ///< unset: the end of the run
};

struct fault_description {
  duration at{}; ///< if it happens more than once, the same as its `from`
  fault what;
  std::optional<fault_times> repeated = std::nullopt;
};

[[nodiscard]] inline bool is_change(const fault_description& x) {
  return std::holds_alternative<change>(x.what);
}

/// Faults by their times, then changes by theirs: which random numbers a fault has depends on its
/// place among the faults alone.
void sort_plan(std::vector<fault_description>& x);

/// A picture under the map of whoever looks at the ecology.
struct floor_plan {
  std::string picture; ///< file, relative to the folder of the TOML file
  position corner;     ///< its lower left one
  double width_m = 0;  ///< [m]; its height follows from the picture
};

struct ecology_description {
  // Compiled once: they are large.
  ecology_description();
  ~ecology_description();
  ecology_description(const ecology_description&);
  ecology_description& operator=(const ecology_description&);
  ecology_description(ecology_description&&) noexcept;
  ecology_description& operator=(ecology_description&&) noexcept;

  std::string name;
  std::uint64_t seed = 1;
  run_mode mode = run_mode::virtual_time;
  duration length = 10min;
  run_end until = run_end::duration;
  duration day_begins{};               ///< time of day at the start of the run, 0 to 24 h
  std::optional<duration> date;        ///< of a virtual run: the day it starts, since 1970
  std::chrono::milliseconds tick{500}; ///< period of the RUBICON clock, everywhere (CLK-03)
  std::string network =
      "rubicon"; ///< PEIS network string: ecologies that differ never meet (LNK-06)
  radio::channel_config radio;
  peis_description peis;
  std::vector<air_description> airs;       ///< every island is in exactly one
  std::vector<island_description> islands; ///< ascending by id
  std::vector<peer_description> peers;     ///< ascending by id; gateways are not among them
  std::vector<bluetooth_device> bluetooth_devices;
  std::vector<proxy::proxy_class> proxies;
  std::vector<tag_description> tags;
  smepp::group_settings smepp;           ///< all its keys are set
  std::vector<fault_description> faults; ///< as sort_plan() has them
  std::vector<expectation> expectations; ///< in the order of the file
  std::vector<host_description> hosts;
  std::optional<part_description> part; ///< unset: all of the ecology is here
  std::optional<floor_plan> plan;
};

/// Calls f with each island, those of other hosts included.
template <class F>
void for_each_island(const ecology_description& x, F f) {
  std::ranges::for_each(x.islands, f);
  if (x.part)
    std::ranges::for_each(x.part->others, f);
}

} // namespace rubicon::config
