// The one typed description of an ecology. load() in config/load.hpp makes it from TOML; whoever
// holds one may rely on it being valid: ids in range and unique, every reference resolved.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "apps/app_config.hpp"
#include "config/plan/change.hpp"
#include "config/plan/expectation.hpp"
#include "config/plan/island.hpp"
#include "config/plan/labels.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"
#include "device/waypoint.hpp"
#include "goal/pursuer_config.hpp"
#include "peis/wire/link_url.hpp"
#include "peisinit/component.hpp"
#include "proxy/classes/proxy_class.hpp"
#include "proxy/rules/rules_config.hpp"
#include "radio/parameters.hpp"
#include "rfid/reader_config.hpp"
#include "smepp/member_config.hpp"
#include "translate/translation.hpp"

namespace rubicon::bridge {
struct mqtt_settings; // bridge/mqtt/mqtt_settings.hpp
struct ros2_settings; // bridge/ros2/ros2_settings.hpp
} // namespace rubicon::bridge

namespace rubicon::config {

enum class run_mode : std::uint8_t { virtual_time, wall };

/// What a run ends with.
enum class run_end : std::uint8_t {
  duration,
  first_flat_battery, ///< of a mote; at the latest after its duration
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

/// Publishes tuples of proxies at an MQTT broker, and writes inputs as others request there.
struct mqtt_app {
  std::shared_ptr<const bridge::mqtt_settings> settings; ///< not nullptr
};

/// Tuples as topics of ROS 2 and back, by a rosbridge.
struct ros2_app {
  std::shared_ptr<const bridge::ros2_settings> settings; ///< not nullptr
};

using peer_app = std::variant<proxy_manager_app, proxy::rules_config, collector_app,
                              rfid::reader_config, goal::pursuer_config, apps::app_config, init_app,
                              translate_app, mqtt_app, ros2_app>;

/// Where a peer takes links over real TCP.
struct tcp_listener {
  std::optional<std::uint16_t> port; ///< unset: the first free one from 8000 on
  std::string address;               ///< IPv4; empty: loopback, with `lan` all
  std::vector<ipv4_network>
      networks; ///< links from others are closed at once; empty: from anywhere
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
  bool lan = false;                   ///< meets whoever the computer's real LAN has
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
  std::optional<mote_address> further_sink = std::nullopt; ///< set: its backbone instead
};

/// A peer's process, its programs included, ends at once. Its links are reset, as an operating
/// system does.
struct kill_fault {
  peer_id peer;                   ///< any_peer: drawn each time, as in the next ones
  std::optional<duration> length; ///< until it is started again; unset: never
};
/// A peer's computer loses its power: no link is closed.
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
  label_table labels;
};

/// Calls f with each island, those of other hosts included.
template <class F>
void for_each_island(const ecology_description& x, F f) {
  std::ranges::for_each(x.islands, f);
  if (x.part)
    std::ranges::for_each(x.part->others, f);
}

} // namespace rubicon::config
