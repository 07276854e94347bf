#include "apps/listener.hpp"

#include <utility>

namespace rubicon::apps {

void listener::on_start(instant) {
  provide(config_.am_type);
}

void listener::receiveFrom(mote_address source, byte_view octets, std::uint8_t) {
  if (!std::exchange(has_received_, true))
    notify("received \"" + to_string(octets) + "\" from mote " + to_string(source));
}

} // namespace rubicon::apps
