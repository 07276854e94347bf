// The keys of [[peer]], of its programs that no other room describes, and of the networks of peers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/label_keys.hpp"
#include "config/plan/ecology.hpp"
#include "config/plan/references.hpp"
#include "config/toml/values.hpp"

namespace rubicon::config {

inline constexpr std::size_t links_max = 16;

inline auto peer_identity_keys() {
  return keys::of(
      keys::required("id", &peer_description::id, whole<std::int32_t>{1, peer_id_max},
                     "PEIS id, unique among peers and islands. Motes can address ids up to 254"),
      keys::required("name", &peer_description::name, labelled_name{},
                     "unique among peers and gateways"));
}

/// How many peers a table describes.
struct peer_count {
  std::uint32_t count = 1;
};

inline auto keys_of(const peer_count*) {
  return keys::of(
      keys::optional("count", &peer_count::count, whole<std::uint32_t>{1, peer_count_max},
                     {"number of peers, with the ids from `id` on and the names `NAME-1`, "
                      "`NAME-2`, ...; all else is the same",
                      "one peer"}));
}

inline auto peer_host_keys() {
  return keys::of(keys::optional(
      "host", &peer_description::host, host_name{},
      {"computer of the peer; links between peers of one host cost nothing; without it, "
       "each peer has a computer of its own",
       "host on which the run is started"}));
}

/// Links of a peer or gateway, with the places that checks need.
struct link_list {
  std::vector<located<std::string>> links;
};

/// @param whom the sentence of the key
inline auto peer_links_keys(const char* whom) {
  return keys::of(keys::optional("links", &link_list::links, list_of<link_end>{{}, 0, links_max},
                                 {whom, "none"}));
}

inline auto peer_address_keys() {
  return keys::of(keys::optional(
      "connect", &peer_description::connect, list_of<peer_url>{{}, 0, links_max},
      {"addresses to which it always keeps a link, over the real network; needs `mode = \"wall\"`",
       "none"}));
}

inline auto listener_keys() {
  return keys::of(
      keys::optional("address", &tcp_listener::address, interface_address{},
                     {"address of this computer; `\"0.0.0.0\"`: all", "loopback, with `lan` all"}),
      keys::optional("networks", &tcp_listener::networks,
                     list_of<network_text>{{}, 0, networks_max},
                     {"networks that links may come from; others are closed at once", "anywhere"}));
}

/// Of the first peer of a table.
struct first_port {
  std::uint16_t port = 0;
};

inline auto keys_of(const first_port*) {
  return keys::of(keys::optional("port", &first_port::port, whole<std::uint16_t>{1, 65535},
                                 {"with `count`, the first peer's; the others have the next ones",
                                  "the first free one from 8000 on"}));
}

inline auto peer_network_keys() {
  return keys::of(
      keys::optional("lan", &peer_description::lan, flag{},
                     "connects to the peers of the real local network: it listens at all "
                     "addresses of this computer, and announces itself to the multicast group "
                     "227.1.3.5, port 10001; needs `mode = \"wall\"`"),
      keys::optional("udp", &peer_description::udp, flag{},
                     "also has links over UDP, with peers that have this as well, on a port of "
                     "the same number as that of `tcp` if it is free; for networks that lose more "
                     "than TCP tolerates; needs `mode = \"wall\"`"));
}

inline auto peer_link_keys() {
  return keys::of(
      keys::optional("leaf", &peer_description::leaf, flag{},
                     "its only links are those to `links`, to `connect`, and within its host"),
      keys::optional("manager", &peer_description::manager, flag{},
                     "it opens and closes links according to traffic and distances; `false`: only "
                     "configured links"));
}

inline auto peer_clock_keys() {
  return keys::of(
      keys::optional(
          "discovery", &peer_description::discovery, flag{},
          {"it takes part in the announcements of the simulated network, by which peers find each "
           "other",
           "`true` if neither `links` nor `connect` is given, else `false`"}),
      keys::optional("time_master", &peer_description::time_master, flag{},
                     "all clocks follow its clock, forwards and backwards; without a master, "
                     "clocks follow the one that is ahead"),
      keys::optional(
          "clock_offset", &peer_description::clock_offset, time_step{},
          {"offset of its own clock from the true time; peers agree on one time within seconds",
           "none"}),
      keys::optional("clock_ppm", &peer_description::clock_ppm, real{-200, 200},
                     "its own clock runs too fast by this many parts per million"),
      keys::optional(
          "managers", &peer_description::managers, list_of<whole<std::int32_t>>{{1, peer_id_max}},
          {"peers that may stop it by writing its tuple `kernel.do-quit`, in addition to those "
           "of its host",
           "none", "array of PEIS ids"}));
}

inline auto peer_place_keys() {
  return keys::of(
      keys::optional(
          "position_m", &peer_description::place, place{},
          {"position of its computer; needed by simulated `bluetooth`, and the same for all peers "
           "of a host",
           "none"}),
      keys::optional("wired", &peer_description::wired, flag{},
                     "it is on the simulated network between hosts; `false`: it has links over "
                     "Bluetooth only, or over the real network"));
}

inline auto object_manager_keys() {
  return keys::of(
      keys::optional("objects", &proxy_manager_app::objects, flag{},
                     "it also starts the proxies of [tagged objects](#tag), whichever reader "
                     "perceives them; at most one manager of a file"));
}

/// Islands of a proxy manager, with the places that checks need.
struct managed_islands {
  std::vector<located<island_id>> islands;
};

/// @param islands_min of them if the key is given
inline auto managed_island_keys(std::size_t islands_min) {
  return keys::of(
      keys::optional("islands", &managed_islands::islands, list_of<island_name>{{}, islands_min},
                     {"islands whose gateways it listens to; an island has one proxy manager",
                      "all islands with the full stack"}));
}

inline auto keys_of(const collector_app*) {
  return keys::of(keys::required("keys", &collector_app::keys, list_of<tuple_key>{{true}, 1},
                                 "a part may be `*`, which stands for any one part"),
                  keys::optional("every", &collector_app::every, time_span{10ms, 24h * 10},
                                 {"requested period of the messages of those motes whose output "
                                  "channels the keys name (`devices.*.output.1`)",
                                  "the motes' own periods"}));
}

inline auto keys_of(const peis_description*) {
  return keys::of(
      keys::optional("delay", &peis_description::delay, time_span{0s, 10s},
                     "delay of each package, per direction"),
      keys::optional("loss", &peis_description::loss, ratio{},
                     "probability that a package, or an announcement at one of its receivers, is "
                     "lost; the first octets of a link, which identify the peers, are never lost"),
      keys::optional("bandwidth", &peis_description::bandwidth_bps, bit_rate{},
                     "of each link, per direction; no limit by default"));
}

inline auto keys_of(const bluetooth_description*) {
  return keys::of(
      keys::optional("range", &bluetooth_description::range_m, metres{0.1, 1000},
                     "devices farther away are not seen, and links longer than this are dropped"),
      keys::optional("rate", &bluetooth_description::rate_bps, bit_rate{},
                     "of each link, per direction; 0 for no limit"),
      keys::optional("scan_period", &bluetooth_description::scan_period, time_span{1s, 30s},
                     "between two scans of an adapter"),
      keys::optional("rssi_threshold", &bluetooth_description::threshold_dbm, power_level{},
                     "no link is opened to devices received more weakly; by default beyond 7.9 m"),
      keys::optional(
          "takeover", &bluetooth_description::takeover, flag{},
          "when the peer that announces on a shared adapter ends, the next one takes over; "
          "`false`: no peer does, and the peers behind that adapter are no longer found"));
}

} // namespace rubicon::config
