#include "cli/ask_hosts.hpp"

#include <chrono>
#include <cstddef>
#include <list>
#include <utility>

#include "control/client.hpp"
#include "io/loop.hpp"

namespace rubicon::cli {

std::vector<std::variant<deploy::answer, std::string>>
ask_hosts(control::system& actors, const std::vector<deployed_host>& hosts,
          const std::function<deploy::question(const deployed_host&)>& what) {
  std::vector<std::variant<deploy::answer, std::string>> answers(hosts.size());
  io::loop loop;
  std::size_t open = hosts.size();
  std::list<control::client> clients;
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    auto question = what(hosts[i]);
    const auto patience = deploy::patience_for(question);
    clients.emplace_back(actors, loop, hosts[i].address, hosts[i].port)
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

} // namespace rubicon::cli
