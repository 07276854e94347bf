#include <algorithm>
#include <utility>

#include "config/file_readers.hpp"
#include "config/run/fault_variation.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t network_octets_max = 62; ///< docs/peis-wire.md 1
constexpr duration tick_max = 8191ms;          ///< 13 bits of a clock stamp

/// "07:30", or "now" for what the computer's clock shows.
struct day_start {
  using type = duration;

  [[nodiscard]] static std::optional<duration> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    if (found == nullptr || *found != "now")
      return time_of_day::read(x, who);
    return who.in.files == nullptr ? duration(0)
                                   : who.in.files->instead.time_of_day.value_or(duration(0));
  }
  [[nodiscard]] static form takes() {
    return {"time of day, `\"07:30\"` or `\"07:30:15\"`, or `\"now\"`",
            pattern_schema("now|([01][0-9]|2[0-3]):[0-5][0-9](:[0-5][0-9])?")};
  }
};

auto run_keys() {
  using x = ecology_description;
  return keys::of(
      keys::required("name", &x::name, name_text{}, "name of the ecology, in reports"),
      keys::optional("seed", &x::seed, whole<std::uint64_t>{0, INT64_MAX},
                     "of all random numbers; the same file and seed give the same virtual run"),
      keys::optional(
          "mode", &x::mode,
          word<run_mode>{{{"virtual", run_mode::virtual_time}, {"wall", run_mode::wall}}},
          "as fast as the computer can, or in real time"),
      keys::optional("duration", &x::length, time_span{1ms}, "of ecology time"),
      keys::optional("until", &x::until,
                     word<run_end>{{{"duration", run_end::duration},
                                    {"first_flat_battery", run_end::first_flat_battery}}},
                     "what the run ends with: its `duration`, or the [first flat "
                     "battery](#first-flat-battery) of a mote, but at the latest its `duration`"),
      keys::optional("start", &x::day_begins, day_start{},
                     {"time of day at the start of the run, for [rules](#rules) with `at`; in wall "
                      "time also `\"now\"`: that of the computer's clock and time zone, including "
                      "daylight saving: a time that a clock change skips occurs at the change, one "
                      "that it repeats occurs once",
                      "`\"00:00\"`"}),
      keys::optional(
          "date", &x::date, calendar_day{},
          {"day on which a run in virtual time starts, at `start`: the [network "
           "time](gateway.md#time) continues from there. In wall time it is the computer's",
           "`\"2001-09-09\"` at 01:46:40"}),
      keys::optional("network", &x::network, text{network_octets_max},
                     "PEIS network string: peers with another one never connect"));
}

/// Period of the RUBICON clock, before it is known to be whole milliseconds.
struct clock_period {
  duration tick{};
};

auto keys_of(const clock_period*) {
  return keys::of(
      keys::optional("tick", &clock_period::tick, time_span{10ms, tick_max},
                     {"period of the RUBICON clock, on all motes and PCs: it ticks at its "
                      "multiples in the time that peers share",
                      "", "time from 10 ms to 8191 ms, whole milliseconds"}));
}

/// read_faults() asks for it, which knows the seed.
struct fault_variation {
  bool leaves_out = false;
};

auto keys_of(const fault_variation*) {
  return keys::of(keys::optional(
      vary_faults_key, &fault_variation::leaves_out, flag{},
      "each run leaves out each kind of [fault](#fault) with probability 0.5, drawn from its seed: "
      "the runs of a [swarm](studies.md#a-swarm-that-varies) meet different combinations"));
}

auto plan_keys() {
  return keys::of(
      keys::required("picture", &floor_plan::picture, text{4096},
                     "its file, a PNG, JPEG, WebP or SVG; not needed for a run"),
      keys::optional("position_m", &floor_plan::corner, place{}, "of its lower left corner"),
      keys::required("width", &floor_plan::width_m, metres{0.1, 100'000},
                     "from its left edge to its right one"));
}

/// What the clock shows is another time in each run, and it may change.
void take_clock(table_reader& in, const ecology_description& x) {
  const auto* given = in.content().find("start");
  const auto* word = given == nullptr ? nullptr : given->as<std::string>();
  const auto* files = in.shared().files;
  const auto mode = files == nullptr ? x.mode : files->instead.mode.value_or(x.mode);
  if (word == nullptr || *word != "now")
    return;
  if (files != nullptr)
    in.shared().clock_changes = files->instead.clock_changes;
  if (mode == run_mode::virtual_time)
    in.problems().add(in.at("start"), "`start` = \"now\" needs mode = \"wall\": a run in virtual "
                                      "time does not depend on when it is run");
}

} // namespace

void read_ecology(table_reader& root, ecology_description& out) {
  const bool found =
      root.table("ecology", "[ecology]", "the run as a whole", [&out](table_reader& in) {
        clock_period clock{out.tick};
        in.all(out, run_keys());
        in.all(clock);
        fault_variation ignored;
        in.all(ignored);
        take_clock(in, out);
        if (in.is_good("tick")) {
          out.tick = std::chrono::duration_cast<std::chrono::milliseconds>(clock.tick);
          if (out.tick != clock.tick)
            in.problems().add(in.at("tick"), "`tick` must be whole milliseconds");
        }
      });
  if (!found && !root.has("ecology"))
    root.problems().add(root.at(), "the file lacks the table [ecology]");
  root.table("plan", "[plan]", "a floor plan, which `--view` shows under the map",
             [&out](table_reader& in) { in.all(out.plan.emplace(), plan_keys()); });
}

void check_end(table_reader& root, const ecology_description& x) {
  const auto* run = root.content().find("ecology");
  const auto* until = run == nullptr ? nullptr : run->find("until");
  if (until == nullptr || x.until == run_end::duration)
    return;
  const auto refuse = [&](const std::string& why) {
    root.problems().add(until->at, "`until = \"first_flat_battery\"` " + why);
  };
  if (!x.hosts.empty())
    refuse("is for a run in one process: the hosts of a file with [[host]] do not tell each other "
           "of batteries");
  if (root.sound() && std::ranges::none_of(x.islands, [](const auto& island) {
        return !island.outside.has_sink() && !island.motes.empty();
      }))
    refuse("means nothing without a simulated mote: no other battery ends");
}

namespace {

/// Where a host listens; empty: not known.
std::string listening_address(const host_description& x) {
  if (parse_ipv4_address(x.address))
    return x.address;
  return x.address == "localhost" ? "127.0.0.1" : "";
}

auto host_keys() {
  using x = host_description;
  return keys::of(keys::required("name", &x::name, name_text{},
                                 "name that `host` of islands and peers refers to"),
                  keys::required("address", &x::address, text{253},
                                 "DNS name or IPv4 address under which other hosts reach it"));
}

auto host_listen_keys() {
  using x = host_description;
  return keys::of(keys::optional("listen", &x::listen, interface_address{},
                                 {"its address for links from other hosts and for commands; "
                                  "`\"0.0.0.0\"`: all",
                                  "`address`, which must be an IPv4 address then"}),
                  keys::optional("control_port", &x::control_port, whole<std::uint16_t>{1, 65534},
                                 "TCP port for commands to `rubicon host`"));
}

auto host_link_keys() {
  using x = host_description;
  return keys::of(
      keys::optional("peis_port", &x::peis_port, whole<std::uint16_t>{1, 65535},
                     {"TCP port of the PEIS links from other hosts", "`control_port` + 1"}),
      keys::optional(
          "networks", &x::networks, list_of<network_text>{{}, 0, networks_max},
          {"networks that those links may come from; others are closed at once", "anywhere"}));
}

host_description read_host(table_reader& in, name_uniqueness& names) {
  host_description host;
  in.all(host, host_keys());
  if (in.is_good("name"))
    names.add(host.name, "host name", in.at("name"), in.problems());
  if (host.address.find(':') != std::string::npos)
    in.problems().add(in.at("address"), "`address` must be a DNS name or an IPv4 address, as in "
                                        "\"192.168.1.7\": links over IPv6 are not made");
  host.listen = listening_address(host);
  in.all(host, host_listen_keys());
  host.peis_port = static_cast<std::uint16_t>(host.control_port + 1);
  in.all(host, host_link_keys());
  return host;
}

} // namespace

std::vector<host_description> read_hosts(table_reader& root) {
  std::vector<host_description> out;
  name_uniqueness names;
  root.tables("host", "[[host]]", "computers; the first one runs everything that names no host",
              [&](table_reader& in) { out.push_back(read_host(in, names)); });
  return out;
}

} // namespace rubicon::config
