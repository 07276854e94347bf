#include "cli/hosts/ask_hosts.hpp"

#include <chrono>
#include <cstddef>
#include <list>
#include <utility>

#include "control/client.hpp"
#include "core/text/shell_word.hpp"
#include "io/loop.hpp"
#include "io/process/machine.hpp"

namespace rubicon::cli {

std::vector<std::variant<deploy::answer, std::string>>
ask_each(control::system& actors, const std::vector<deployed_host>& hosts,
         const std::function<deploy::question(const deployed_host&)>& what) {
  std::vector<std::variant<deploy::answer, std::string>> answers(hosts.size());
  io::loop loop;
  std::size_t open = hosts.size();
  std::list<control::client> clients;
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    auto question = what(hosts[i]);
    const auto patience = deploy::patience_for(question);
    clients.emplace_back(actors, loop, hosts[i].address, hosts[i].port, hosts[i].certificate_name())
        .ask(std::move(question), patience,
             [&, i](std::variant<deploy::answer, std::string> found) {
               answers[i] = std::move(found);
               --open;
             });
  }
  while (open > 0)
    loop.wait_until(std::chrono::steady_clock::now() + 1s);
  return answers;
}

std::string host_command_line(const deployed_host& host, bool with_certificates) {
  const auto files = " --tls-cert " + shell_word(host.name + ".crt") + " --tls-key " +
                     shell_word(host.name + ".key") + " --tls-ca ca.crt";
  return "rubicon host --name " + shell_word(host.name) + " --listen " + host.address + ':' +
         std::to_string(host.port) + (with_certificates ? files : "");
}

std::vector<std::string> problems_of(const received_verdict& x) {
  const auto* why = std::get_if<std::string>(&x);
  return why != nullptr ? std::vector{*why} : std::get<deploy::verdict>(x).problems;
}

std::vector<std::variant<received_facts, std::string>>
ask_facts_of(control::system& actors, const std::vector<deployed_host>& hosts) {
  const auto before_us = io::system_clock_us();
  auto answers = ask_hosts(actors, hosts, [](const auto&) { return deploy::ask_facts{}; });
  const auto now_us = (before_us + io::system_clock_us()) / 2;
  std::vector<std::variant<received_facts, std::string>> out;
  for (auto& each : answers) {
    if (auto* why = std::get_if<std::string>(&each)) {
      out.emplace_back(std::move(*why));
      continue;
    }
    auto& facts = std::get<deploy::host_facts>(each);
    const auto ahead_s = 1e-6 * static_cast<double>(facts.clock_us - now_us);
    out.emplace_back(received_facts{std::move(facts), ahead_s});
  }
  return out;
}

} // namespace rubicon::cli
