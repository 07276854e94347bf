#include "cli/deployed_command.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/ask_hosts.hpp"
#include "cli/console.hpp"
#include "cli/deployed.hpp"
#include "control/system.hpp"
#include "core/overloads.hpp"
#include "core/printable.hpp"
#include "report/figures.hpp"
#include "report/text_layout.hpp"

namespace rubicon::cli {

namespace {

using answers = std::vector<std::variant<deploy::answer, std::string>>;

std::int64_t clock_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

const deploy::host_facts* facts_of(const answers& all, std::size_t i) {
  const auto* answer = std::get_if<deploy::answer>(&all[i]);
  return answer == nullptr ? nullptr : std::get_if<deploy::host_facts>(answer);
}

/// Of the ecology that was deployed; a host may run another one by now.
std::string state_of(const deployed& x, const deploy::host_facts& facts) {
  if (facts.deployment.empty() || facts.deployment == x.id)
    return to_string(facts.state);
  return std::string(to_string(facts.state)) + " `" + facts.ecology + '`';
}

std::string status_table(const deployed& x, const answers& all, std::int64_t now_us) {
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
    const auto* facts = facts_of(all, i);
    if (facts == nullptr) {
      table.add({report::printable(host.name),
                 place,
                 {report::printable(std::get<std::string>(all[i])), report::look::bad},
                 "",
                 "",
                 "",
                 ""});
      continue;
    }
    table.add({report::printable(host.name), place, report::printable(state_of(x, *facts)),
               to_text(std::chrono::floor<std::chrono::seconds>(facts->elapsed)),
               std::to_string(facts->lives), std::to_string(facts->memory >> 20) + " MiB",
               report::fixed(1e-6 * static_cast<double>(facts->clock_us - now_us), 3) + " s"});
  }
  const auto output = console_of(stdout);
  return x.ecology + "  " + x.file + '\n' + table.render(output.width, output.colour);
}

std::string status_json(const deployed& x, const answers& all, std::int64_t now_us) {
  using nlohmann::ordered_json;
  ordered_json hosts = ordered_json::array();
  for (std::size_t i = 0; i < x.hosts.size(); ++i) {
    ordered_json row{
        {"host", x.hosts[i].name}, {"address", x.hosts[i].address}, {"port", x.hosts[i].port}};
    if (const auto* facts = facts_of(all, i)) {
      row["state"] = to_string(facts->state);
      row["ecology"] = facts->ecology;
      row["is_this"] = facts->deployment == x.id;
      row["elapsed_s"] = seconds(facts->elapsed);
      row["processes"] = facts->lives;
      row["memory_octets"] = facts->memory;
      row["clock_ahead_s"] = 1e-6 * static_cast<double>(facts->clock_us - now_us);
    } else {
      row["trouble"] = std::get<std::string>(all[i]);
    }
    hosts.push_back(std::move(row));
  }
  const ordered_json out{
      {"ecology", x.ecology}, {"file", x.file}, {"deployment", x.id}, {"hosts", std::move(hosts)}};
  return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

class asker {
public:
  explicit asker(const deployed& x) : running_(x), actors_(x.tls) {}

  exit_status operator()(const ask_status& x) {
    const auto before_us = clock_us();
    const auto all = ask_hosts(actors_, running_.hosts,
                               [](const auto& host) { return deploy::ask_facts{host.name}; });
    const auto now_us = (before_us + clock_us()) / 2;
    bool all_answer = true;
    for (std::size_t i = 0; i < all.size(); ++i)
      all_answer = all_answer && facts_of(all, i) != nullptr;
    const auto text =
        x.json ? status_json(running_, all, now_us) : status_table(running_, all, now_us);
    if (!print(stdout, text))
      return exit_status::refused;
    return all_answer ? exit_status::good : exit_status::failed;
  }

  exit_status operator()(const stop_all&) {
    return tell(ask_hosts(actors_, running_.hosts,
                          [this](const auto&) { return deploy::end_part{running_.id}; }));
  }

  exit_status operator()(const fault_now& x) {
    const auto all = ask_hosts(actors_, running_.hosts, [&](const auto&) {
      return deploy::cause_fault{running_.id, x.sentence};
    });
    const auto status = tell(all);
    if (status == exit_status::good && !somebody_is_concerned(all))
      return say("nothing that it names is on any host");
    return status;
  }

private:
  static bool somebody_is_concerned(const answers& all) {
    for (const auto& each : all)
      if (std::get<deploy::verdict>(std::get<deploy::answer>(each)).concerned)
        return true;
    return false;
  }

  static exit_status say(const std::string& text) {
    static_cast<void>(print(stderr, printable(text) + '\n'));
    return exit_status::refused;
  }

  /// What is in the way, the same once.
  exit_status tell(const answers& all) {
    auto status = exit_status::good;
    std::vector<std::string> told;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto& name = running_.hosts[i].name;
      if (const auto* why = std::get_if<std::string>(&all[i])) {
        static_cast<void>(say(name + "  " + *why));
        status = exit_status::failed;
        continue;
      }
      for (const auto& each :
           std::get<deploy::verdict>(std::get<deploy::answer>(all[i])).problems) {
        static_cast<void>(say(name + "  " + each));
        status = exit_status::refused;
      }
    }
    return status;
  }

  const deployed& running_;
  control::system actors_;
};

} // namespace

exit_status perform(const deployed_command& x) {
  const auto found = remembered(x.ecology);
  if (!found) {
    static_cast<void>(
        print(stderr,
              x.ecology.empty()
                  ? "rubicon: you have deployed nothing that runs; `rubicon deploy FILE --attach` "
                    "finds what somebody else has deployed\n"
                  : "rubicon: you have deployed no `" + printable(x.ecology) + "` that runs\n"));
    return exit_status::refused;
  }
  return std::visit(asker(*found), x.what);
}

} // namespace rubicon::cli
