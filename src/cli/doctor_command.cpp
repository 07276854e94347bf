#include "cli/doctor_command.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "cli/ecology_file.hpp"
#include "cli/hosts/ask_hosts.hpp"
#include "cli/hosts/deployed.hpp"
#include "cli/print/console.hpp"
#include "cli/random_id.hpp"
#include "cli/words/version.hpp"
#include "config/plan/placement.hpp"
#include "control/system.hpp"
#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "deploy/bundle.hpp"
#include "io/bluetooth/bluetooth_adapter.hpp"
#include "io/files/stored_number.hpp"
#include "io/loop.hpp"
#include "io/process/machine.hpp"
#include "io/serial/serial_devices.hpp"
#include "io/tls/certificates.hpp"
#include "io/tls/tls_identity.hpp"
#include "io/tls/tls_keeper.hpp"
#include "io/udp/udp_group.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

/// A warning keeps nothing from working now that the file needs.
enum class severity : std::uint8_t { ok, warning, fault };

/// What was looked at, and what is wrong with it.
struct finding {
  std::string what;
  std::string found;
  std::string advice = {}; ///< what to do; empty: nothing is wrong
  severity how_bad = severity::fault;

  [[nodiscard]] severity judged() const { return advice.empty() ? severity::ok : how_bad; }
};

using findings = std::vector<finding>;

/// What the file needs of this computer; without a file nobody knows.
struct file_needs {
  bool file = false;
  bool hosts = false;                    ///< parts run elsewhere
  bool network = false;                  ///< anything outside this computer
  bool multicast = false;                ///< peers with `lan`
  std::vector<std::string> devices = {}; ///< serial ports

  /// Of a check that the file does not need.
  [[nodiscard]] severity unless(bool is_needed) const {
    return !file ? severity::warning : is_needed ? severity::fault : severity::ok;
  }
};

file_needs needs_of(const config::ecology_description& x) {
  file_needs out{.file = true, .hosts = !x.hosts.empty()};
  for (const auto& peer : x.peers) {
    out.multicast = out.multicast || peer.lan;
    out.network = out.network || config::has_real_links(peer);
  }
  out.network = out.network || out.hosts;
  for (const auto& island : x.islands)
    for (const auto* line : {&island.outside, &island.real.outside})
      if (!line->device.empty() && !out.hosts) // those of hosts are theirs
        out.devices.push_back(line->device);
  return out;
}

/// Time enough to make another.
constexpr std::chrono::days certificate_left_least(14);

constexpr const char* any_use_advice =
    "restrict it to one use, where ca.key is: rubicon certs renew --host, or --coordinator";

std::string address_text(const io::network_interface& x) {
  std::string text;
  for (const auto octet : x.ipv4)
    text += (text.empty() ? "" : ".") + std::to_string(octet);
  return text;
}

finding look_at_network(const file_needs& wanted) {
  std::string found;
  for (const auto& each : io::network_interfaces())
    if (!each.loopback)
      found += (found.empty() ? "" : ", ") + each.device + ' ' + address_text(each);
  const auto how_bad =
      wanted.unless(wanted.network) == severity::ok ? severity::ok : severity::warning;
  return {"network", found.empty() ? "loopback only" : found,
          found.empty() && how_bad != severity::ok
              ? "connect this computer to the other hosts' network, unless all run here"
              : "",
          how_bad};
}

/// Whether an own datagram comes back. It leaves this computer nowhere, and goes to a port that no
/// PEIS kernel listens to.
finding look_at_multicast(const file_needs& wanted) {
  const auto how_bad = wanted.unless(wanted.multicast);
  if (how_bad == severity::ok)
    return {"multicast", "not needed: no peer of the file has `lan`"};

  constexpr duration patience = 1s;
  io::loop loop;
  io::udp_group_config config;
  ++config.port;
  config.hops_max = 0;
  const auto mark = random_id();
  bool received = false;
  auto joined = io::udp_group::join(loop, config, [&](byte_view datagram, const ipv4_address&) {
    received = received || std::ranges::equal(datagram, mark);
  });
  const std::string advice = "peers with `lan = true` do not find each other: add a route for "
                             "multicast (ip route add 224.0.0.0/4 dev DEVICE), or set links with "
                             "`connect`; links between [[host]]s need no multicast";
  if (const auto* why = std::get_if<std::string>(&joined))
    return {"multicast", *why, advice, how_bad};
  auto& group = std::get<io::udp_group>(joined);
  if (const auto why = group.trouble(); !why.empty())
    return {"multicast", why, advice, how_bad};
  group.send(byte_view(reinterpret_cast<const std::uint8_t*>(mark.data()), mark.size()));
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!received && std::chrono::steady_clock::now() < until)
    loop.wait_until(until);
  return {"multicast", received ? "works" : "no packet came back", received ? "" : advice, how_bad};
}

finding look_at_clock(bool matters) {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const std::chrono::year_month_day today(std::chrono::floor<std::chrono::days>(now));
  const auto year = static_cast<int>(today.year());
  return {"clock", io::time_text(now),
          year < 2025 ? "set it: certificates are not valid yet (timedatectl set-ntp true)" : "",
          matters ? severity::fault : severity::warning};
}

finding look_at_descriptors() {
  constexpr rlim_t wanted = 1024;
  rlimit x{};
  static_cast<void>(::getrlimit(RLIMIT_NOFILE, &x));
  return {"open files", "at most " + std::to_string(x.rlim_cur),
          x.rlim_cur < wanted ? "raise it: ulimit -n 1024, or LimitNOFILE= of the service" : "",
          severity::warning};
}

finding look_at_state() {
  const auto path = io::state_file("doctor");
  if (path.empty())
    return {"state folder", "none", "set HOME or XDG_STATE_HOME to a writable folder",
            severity::warning};
  return {"state folder", std::filesystem::path(path).parent_path().string()};
}

/// Ports that this computer has, and those of the file that it lacks.
void look_at_serial(const file_needs& wanted, findings& out) {
  const auto all = io::serial_devices();
  const auto is_used = [&wanted](const std::string& path) {
    return std::ranges::find(wanted.devices, path) != wanted.devices.end();
  };
  if (all.empty() && wanted.devices.empty())
    out.push_back({"serial", "no device"});
  for (const auto& each : all) {
    const auto how_bad = wanted.unless(is_used(each.path));
    out.push_back({"serial", each.path + (each.problem.empty() ? "" : ": " + each.problem),
                   each.problem.empty() || how_bad == severity::ok
                       ? ""
                       : "join the group that owns it: sudo usermod -aG dialout $USER, then log in "
                         "again",
                   how_bad});
  }
  for (const auto& path : wanted.devices)
    if (std::error_code ignored; !std::filesystem::exists(path, ignored))
      out.push_back({"serial", path + ": No such file or directory",
                     "plug in the mote's programming board, or correct `device`"});
}

/// Adapters that this computer has. What is wrong with one matters if a peer of the file uses it.
void look_at_bluetooth(const config::ecology_description* file, findings& out) {
  std::map<std::string, bool> adapters; // whether one is used
  for (const auto& name : io::bluetooth_adapters())
    adapters[name] = false;
  if (file != nullptr) {
    for (const auto& peer : file->peers)
      if (!peer.adapter.empty())
        adapters[peer.adapter] = true;
  }
  for (const auto& [name, is_used] : adapters) {
    const auto found = io::open_bluetooth_adapter(name);
    const auto* why = std::get_if<std::string>(&found);
    out.push_back({"bluetooth", why != nullptr ? *why : name,
                   why != nullptr && is_used
                       ? "plug it in and switch it on (bluetoothctl power on), or correct `adapter`"
                       : ""});
  }
}

/// @returns whether hosts can be asked with them
bool look_at_certificates(const control::tls_files& tls, findings& out) {
  if (tls.empty())
    return true;
  std::optional<io::tls_keeper> found;
  try {
    found.emplace(tls);
  } catch (const std::runtime_error& why) {
    out.push_back({"certificate", why.what(),
                   "see rubicon certs list; certs renew, add and init make new ones"});
    return false;
  }
  const auto& own = *found->identity();
  const auto left = own.valid_until() - io::system_time();
  out.push_back(
      {"certificate",
       tls.certificate + " of `" + own.name() + "` until " + io::time_text(own.valid_until()),
       left < certificate_left_least ? "it expires soon: rubicon certs renew makes a new one" : "",
       severity::warning});
  if (own.use() == io::certificate_use::any)
    out.push_back({"certificate",
                   tls.certificate + " is valid both for a host and for a coordinator",
                   any_use_advice, severity::warning});
  const auto& list = found->revoked();
  out.push_back({"revoked",
                 list ? "list " + std::to_string(list->number()) + " has " +
                            report::counted(list->size(), "certificate")
                      : "no list",
                 ""});
  return true;
}

/// What a host knows of revoked certificates, and whether it could deploy itself.
void look_at_use(const deploy::host_facts& theirs, const io::tls_keeper& own,
                 const std::string& name, findings& out) {
  const auto ours = own.revoked() ? own.revoked()->number() : 0;
  if (theirs.revocations > ours)
    out.push_back(
        {name,
         "has list " + std::to_string(theirs.revocations) + " of revoked certificates" +
             (ours == 0 ? ", this computer has none"
                        : ", this computer has " + std::to_string(ours)),
         "copy ca.crl from the folder of the authority into the folder of " + own.files().authority,
         severity::warning});
  if (theirs.revocations < ours)
    out.push_back({name,
                   "does not accept list " + std::to_string(ours) + " of revoked certificates",
                   "see its log", severity::warning});
  if (theirs.may_deploy)
    out.push_back({name, "its certificate is valid both for a host and for a coordinator",
                   any_use_advice, severity::warning});
}

/// @param why a host does not answer
/// @param place its address and port
std::string advice_for(const std::string& why, const std::string& host, const std::string& place) {
  const auto has = [&why](std::string_view part) { return why.find(part) != std::string::npos; };
  if (has("clock there is wrong") || has("one of the two clocks"))
    return "set the clock that is wrong (timedatectl set-ntp true), here or there";
  if (has("revoked"))
    return "make a new certificate with a new key, where ca.key is: rubicon certs renew --new-key; "
           "also if its name was revoked by mistake";
  if (has("expired"))
    return "make a new certificate where ca.key is: rubicon certs renew";
  if (has("another authority"))
    return "make both certificates with the same ca.key";
  if (has("presented the certificate of"))
    return "correct `address`, or give the host its own files";
  if (has("certificate"))
    return "give both ends certificates of the same authority (--tls-cert, --tls-key, --tls-ca)";
  return "start rubicon host --name " + host + " there, with --listen " + place +
         " and the --tls-cert, --tls-key and --tls-ca of one authority, and open the port in its "
         "firewall";
}

/// What hosts say of themselves, and of the part that is theirs.
void look_at_hosts(const doctor_command& x, const deploy::packed& file, findings& out) {
  constexpr double clock_off_max_s = 60;
  const auto hosts = hosts_of(*file.loaded.ecology);
  control::system actors(x.tls);
  const auto greeted =
      ask_hosts(actors, hosts, [](const auto&) { return deploy::greeting{version}; });
  const auto facts = ask_facts_of(actors, hosts);
  const auto offered = ask_hosts(actors, hosts, [&](const auto& host) {
    return deploy::offer{{}, host.name, part_of(file, host.name), "off", /*only_asks=*/true};
  });
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    const auto name = "host " + hosts[i].name;
    const auto place = hosts[i].address + ':' + std::to_string(hosts[i].port);
    if (const auto* why = std::get_if<std::string>(&greeted[i])) {
      out.push_back({name, place + ' ' + *why, advice_for(*why, hosts[i].name, place)});
      continue;
    }
    const auto& theirs = std::get<deploy::greeting>(greeted[i]).version;
    out.push_back({name, place + " runs rubicon " + theirs,
                   theirs == version ? "" : std::string("install ") + version + " on both"});
    const auto* received = std::get_if<received_facts>(&facts[i]);
    if (theirs != version || received == nullptr ||
        !std::holds_alternative<deploy::verdict>(offered[i]))
      continue;
    if (received->facts.host != hosts[i].name)
      out.push_back({name, "has the name `" + received->facts.host + '`',
                     "start it with --name " + hosts[i].name + ", or correct `address`"});
    out.push_back({name, "clock " + report::fixed(received->clock_ahead_s, 3) + " s ahead of ours",
                   std::abs(received->clock_ahead_s) > clock_off_max_s
                       ? "set it (timedatectl set-ntp true): certificates and logs depend on it"
                       : ""});
    look_at_use(received->facts, actors.own(), name, out);
    const auto problems = problems_of(offered[i]);
    for (const auto& each : problems)
      out.push_back({name, "cannot run its part", each});
    if (problems.empty())
      out.push_back({name, "can run its part"});
  }
}

std::string_view word_of(severity x) {
  return x == severity::ok ? "ok" : x == severity::warning ? "warning" : "fault";
}

/// A line for each check: `fault    host care  does not answer; start rubicon host there`
std::string text_of(const findings& all) {
  const auto output = console_of(stdout);
  std::size_t what_width = 0;
  for (const auto& x : all)
    what_width = std::max(what_width, report::display_width(report::printable(x.what)));
  std::string text;
  for (const auto& x : all) {
    const auto what = report::printable(x.what);
    const auto word = word_of(x.judged());
    const auto how = x.judged() == severity::ok      ? report::look::good
                     : x.judged() == severity::fault ? report::look::bad
                                                     : report::look::strong;
    text += report::painted(word, how, output.colour) + report::blanks(word, 9) + what +
            report::blanks(what, what_width + 2) + report::printable(x.found) +
            (x.advice.empty() ? "" : "; " + report::printable(x.advice)) + '\n';
  }
  return text;
}

std::string json_of(const findings& all) {
  auto out = nlohmann::ordered_json::array();
  for (const auto& x : all) {
    nlohmann::ordered_json row{{"what", x.what},
                               {"found", x.found},
                               {"good", x.judged() == severity::ok},
                               {"level", word_of(x.judged())}};
    if (!x.advice.empty())
      row["advice"] = x.advice;
    out.push_back(std::move(row));
  }
  return json_lines(out) + '\n';
}

/// The file, if one is given and good. @returns whether there is nothing to refuse
bool take_file(const doctor_command& x, std::optional<deploy::packed>& out) {
  if (x.file.empty())
    return true;
  config::overrides instead;
  instead.mode = config::run_mode::wall;
  out.emplace(deploy::pack(x.file, instead, std::nullopt, x.known));
  complain(out->loaded, x.file);
  return out->loaded.ecology && out->loaded.problems.empty();
}

} // namespace

exit_status perform(const doctor_command& x) {
  std::optional<deploy::packed> file;
  if (!take_file(x, file))
    return exit_status::refused;
  const auto* ecology = file ? &*file->loaded.ecology : nullptr;
  const auto wanted = ecology != nullptr ? needs_of(*ecology) : file_needs();
  findings all{{"rubicon", version}};
  all.push_back(look_at_network(wanted));
  all.push_back(look_at_multicast(wanted));
  all.push_back(look_at_clock(wanted.hosts || !x.tls.empty()));
  all.push_back(look_at_descriptors());
  all.push_back(look_at_state());
  look_at_serial(wanted, all);
  const bool can_ask = look_at_certificates(x.tls, all);
  look_at_bluetooth(ecology, all);
  if (ecology != nullptr) {
    for (const auto& each : config::placement_problems(*ecology))
      all.push_back({"file", x.file, each});
    if (can_ask && wanted.hosts)
      look_at_hosts(x, *file, all);
  }
  const bool good =
      std::ranges::none_of(all, [](const auto& each) { return each.judged() == severity::fault; });
  if (!print(stdout, x.json ? json_of(all) : text_of(all)))
    return exit_status::refused;
  return good ? exit_status::good : exit_status::failed;
}

} // namespace rubicon::cli
