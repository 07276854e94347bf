#include "cli/print/plan_text.hpp"

#include <vector>

#include "config/plan/placement.hpp"
#include "config/summary_parts.hpp"
#include "core/text/printable.hpp"

namespace rubicon::cli {

namespace {

std::string joined_or_nothing(const std::vector<std::string>& words) {
  return words.empty() ? "nothing" : config::joined(words);
}

} // namespace

std::string plan_text(const config::ecology_description& all) {
  std::string text;
  for (const auto& host : config::used_hosts(all)) {
    const auto part = config::part_of(all, host.name);
    const auto* const link = config::host_peer(part);
    std::vector<std::string> islands;
    std::vector<std::string> peers;
    for (const auto& each : part.islands)
      islands.push_back(each.name);
    for (const auto& each : part.peers)
      if (&each != link)
        peers.push_back(each.name);
    text += printable(host.name + "  " + host.address) + "  control port " +
            std::to_string(host.control_port) +
            (link == nullptr ? "" : ", PEIS port " + std::to_string(host.peis_port)) +
            "\n  islands  " + printable(joined_or_nothing(islands)) + "\n  peers    " +
            printable(joined_or_nothing(peers)) + '\n';
  }
  return text;
}

} // namespace rubicon::cli
