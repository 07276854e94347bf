#include "apps/requested_messages.hpp"

#include <string>

namespace rubicon::apps {

void requested_messages::send(std::uint32_t number, mote_address to, byte_view octets,
                              bool reliable, std::uint8_t am_type) {
  const auto accepted = layer().send_numbered(to, octets, reliable, am_type);
  if (!accepted)
    notify_outcome(number, " refused");
  else if (reliable)
    in_flight_[*accepted] = number;
}

void requested_messages::ackOf(std::uint32_t number, communication::status success) {
  const auto sent = in_flight_.extract(number);
  if (!sent.empty())
    notify_outcome(sent.mapped(),
                   success == communication::SUCCESS ? " acknowledged" : " not acknowledged");
}

void requested_messages::notify_outcome(std::uint32_t number, const char* outcome) {
  notify("message " + std::to_string(number) + outcome);
}

} // namespace rubicon::apps
