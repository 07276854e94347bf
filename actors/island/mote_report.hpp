// What one life of a mote reports to the ecology.
#pragma once

#include <cstdint>

#include "actors/island/mote_shell.hpp"
#include "actors/island/smepp_shell.hpp"

namespace rubicon {

class mote_report {
public:
  explicit mote_report(mote_pointer self) : self_(self) {}

  /// All that it has counted. @param life whether its stack runs on
  void send(life_state life) const;

  /// A sample of a mote that runs; nothing of another.
  void send_sample(std::uint64_t number) const;

private:
  void send_messages(bool is_alive) const;
  void send_network(bool is_alive) const;

  mote_pointer self_;
};

} // namespace rubicon
