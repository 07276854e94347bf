#include "cli/network/network_commands.hpp"

#include <memory>

#include "cli/network/find_network.hpp"
#include "cli/network/session.hpp"
#include "cli/print/console.hpp"
#include "core/text/printable.hpp"

namespace rubicon::cli {

exit_status fail(const std::string& why) {
  say("rubicon: " + why);
  return exit_status::failed;
}

exit_status answer(const std::string& text) {
  return print(stdout, text) ? exit_status::good : exit_status::refused;
}

exit_status perform(const network_command& x) {
  for (const auto& option : x.with.without_effect)
    say(option + " has no effect here");
  io::loop loop;
  auto joined = join_network(loop, x.with);
  if (const auto* why = std::get_if<std::string>(&joined))
    return fail(*why);
  const auto& network = std::get<joined_network>(joined);
  const session at{loop, network.with, *network.self};
  return std::visit([&](const auto& what) { return perform(at, what); }, x.what);
}

} // namespace rubicon::cli
