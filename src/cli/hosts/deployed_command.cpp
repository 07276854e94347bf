#include "cli/hosts/deployed_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/hosts/ask_hosts.hpp"
#include "cli/hosts/deployed.hpp"
#include "cli/print/console.hpp"
#include "config/summary_parts.hpp"
#include "control/system.hpp"
#include "core/overloads.hpp"
#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

using all_facts = std::vector<std::variant<received_facts, std::string>>;

/// Of the ecology that was deployed; a host may run another one by now.
std::string state_of(const deployed& x, const deploy::host_facts& facts) {
  if (facts.deployment.empty() || facts.deployment == x.id)
    return to_string(facts.state);
  return std::string(to_string(facts.state)) + " `" + facts.ecology + '`';
}

std::string status_table(const deployed& x, const all_facts& all) {
  report::table table({{"host"},
                       {"address"},
                       {"state"},
                       {"time", report::align::right},
                       {"processes", report::align::right},
                       {"memory", report::align::right},
                       {"clock", report::align::right}});
  for (std::size_t i = 0; i < x.hosts.size(); ++i) {
    const auto& host = x.hosts[i];
    const auto place = host.address + ':' + std::to_string(host.port);
    const auto* received = std::get_if<received_facts>(&all[i]);
    if (received == nullptr) {
      table.add({report::printable(host.name),
                 place,
                 {report::printable(std::get<std::string>(all[i])), report::look::bad},
                 "",
                 "",
                 "",
                 ""});
      continue;
    }
    table.add({report::printable(host.name), place, report::printable(state_of(x, received->facts)),
               to_text(std::chrono::floor<std::chrono::seconds>(received->facts.elapsed)),
               std::to_string(received->facts.lives),
               std::to_string(received->facts.memory >> 20) + " MiB",
               report::fixed(received->clock_ahead_s, 3) + " s"});
  }
  const auto output = console_of(stdout);
  return x.ecology + "  " + x.file + '\n' + table.render(output.room(), output.colour);
}

std::string status_json(const deployed& x, const all_facts& all) {
  using nlohmann::ordered_json;
  ordered_json hosts = ordered_json::array();
  for (std::size_t i = 0; i < x.hosts.size(); ++i) {
    ordered_json row{
        {"host", x.hosts[i].name}, {"address", x.hosts[i].address}, {"port", x.hosts[i].port}};
    if (const auto* received = std::get_if<received_facts>(&all[i])) {
      const auto& facts = received->facts;
      row["state"] = to_string(facts.state);
      row["ecology"] = facts.ecology;
      row["is_this"] = facts.deployment == x.id;
      row["elapsed_s"] = seconds(facts.elapsed);
      row["processes"] = facts.lives;
      row["memory_octets"] = facts.memory;
      row["clock_ahead_s"] = received->clock_ahead_s;
    } else {
      row["trouble"] = std::get<std::string>(all[i]);
    }
    hosts.push_back(std::move(row));
  }
  const ordered_json out{
      {"ecology", x.ecology}, {"file", x.file}, {"deployment", x.id}, {"hosts", std::move(hosts)}};
  return json_lines(out) + '\n';
}

class asker {
public:
  explicit asker(const deployed& x) : running_(x), actors_(x.tls) {}

  exit_status operator()(const ask_status& x) {
    const auto all = ask_facts_of(actors_, running_.hosts);
    const bool all_answer = std::ranges::all_of(
        all, [](const auto& each) { return std::holds_alternative<received_facts>(each); });
    if (!print(stdout, x.json ? status_json(running_, all) : status_table(running_, all)))
      return exit_status::refused;
    return all_answer ? exit_status::good : exit_status::failed;
  }

  exit_status operator()(const stop_all&) {
    return print_problems(ask_hosts(actors_, running_.hosts,
                                    [this](const auto&) { return deploy::end_part{running_.id}; }));
  }

  exit_status operator()(const fault_now& x) {
    const auto all = ask_hosts(actors_, running_.hosts, [&](const auto&) {
      return deploy::cause_fault{running_.id, x.sentence};
    });
    const auto status = print_problems(all);
    if (status != exit_status::good)
      return status;
    const auto who = concerned(all);
    if (who.empty())
      return say("rubicon: no host has what it names: `rubicon status` lists the hosts, `rubicon "
                 "check " +
                 running_.file + " --list` what runs on them");
    const bool is_printed = print(stdout, printable("done by " + who + ": " + x.sentence) + '\n');
    return is_printed ? exit_status::good : exit_status::refused;
  }

private:
  /// The hosts that have what a fault is about: `kitchen, care`
  [[nodiscard]] std::string concerned(const std::vector<received_verdict>& all) const {
    std::string names;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (std::get<deploy::verdict>(all[i]).concerned)
        names += (names.empty() ? "" : ", ") + running_.hosts[i].name;
    return names;
  }

  static exit_status say(const std::string& text) {
    static_cast<void>(print(stderr, printable(text) + '\n'));
    return exit_status::refused;
  }

  /// Prints each objection once: what all hosts object is a mistake of the command.
  exit_status print_problems(const std::vector<received_verdict>& all) {
    auto status = exit_status::good;
    std::vector<std::pair<std::string, std::vector<std::string>>> objections; ///< and whose
    for (std::size_t i = 0; i < all.size(); ++i)
      for (const auto& each : problems_of(all[i])) {
        const auto same = std::ranges::find(objections, each,
                                            [](const auto& objection) { return objection.first; });
        auto& who = same != objections.end()
                        ? same->second
                        : objections.emplace_back(each, std::vector<std::string>()).second;
        who.push_back(running_.hosts[i].name);
        status = std::holds_alternative<deploy::verdict>(all[i]) ? exit_status::refused
                                                                 : exit_status::failed;
      }
    for (const auto& [text, who] : objections)
      static_cast<void>(say(who.size() > 1 && who.size() == all.size()
                                ? "rubicon: " + text
                                : config::joined(who, ", ") + "  " + text));
    return status;
  }

  const deployed& running_;
  control::system actors_;
};

} // namespace

exit_status perform(const deployed_command& x) {
  const auto found = remembered(x.ecology);
  if (!found) {
    static_cast<void>(print(
        stderr, x.ecology.empty() ? "rubicon: none of your deployments is running; `rubicon deploy "
                                    "FILE --attach` finds one deployed by another user\n"
                                  : "rubicon: you have deployed no `" + printable(x.ecology) +
                                        "` that is running\n"));
    return exit_status::refused;
  }
  return std::visit(asker(*found), x.what);
}

} // namespace rubicon::cli
