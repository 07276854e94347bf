#include "peisinit/component.hpp"

namespace rubicon::peisinit {

std::string options_for(const component& x, const std::string& arguments, const host_facts& host) {
  auto text = "--peis-id " + to_string(x.id) + " --peis-hostname " + host.name +
              " --peis-network " + host.network;
  if (host.port != 0)
    text += " --peis-connect tcp://localhost:" + std::to_string(host.port);
  return arguments.empty() ? text : text + ' ' + arguments;
}

} // namespace rubicon::peisinit
