#include "deploy/messages.hpp"

namespace rubicon::deploy {

const char* to_string(part_state x) {
  switch (x) {
  case part_state::none:
    return "idle";
  case part_state::offered:
    return "ready";
  case part_state::running:
    return "running";
  case part_state::waiting:
    return "starting again";
  case part_state::ended:
    break;
  }
  return "ended";
}

} // namespace rubicon::deploy
