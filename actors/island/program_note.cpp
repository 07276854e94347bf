#include "actors/island/program_note.hpp"

#include <array>

namespace rubicon {

explain::record record_of(const communication::program_note& x, const std::string& node) {
  using explain::kind;
  using note = communication::program_note::kind;
  constexpr std::array kinds{kind::send_message, kind::send_ended, kind::message_received,
                             kind::actuator_changed};
  explain::record r;
  r.what = kinds[static_cast<std::size_t>(x.what)];
  r.from = x.what == note::sent && !x.program.empty() ? std::string(x.program) : node;
  r.to = x.what == note::sent ? node : std::string(x.program);
  r.id = x.number;
  r.mote = x.other;
  r.channel = x.am_type;
  r.text = x.what == note::send_ended && x.number == 0 ? "refused" : std::string(x.actuator);
  r.octets = to_bytes(x.octets);
  r.count = x.state;
  r.yes = x.yes;
  return r;
}

} // namespace rubicon
