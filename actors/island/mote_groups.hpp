// SMEPP Light of a mote, beside its stack if there is one.
#pragma once

#include <cstdint>
#include <string>

#include "actors/island/mote_shell.hpp"
#include "core/bytes.hpp"
#include "radio/frame.hpp"
#include "smepp/node.hpp"

namespace rubicon {

class mote_groups {
public:
  explicit mote_groups(mote_pointer self) : self_(self) {}

  /// Nothing without an app `member`. @param life names its random streams
  void start(const std::string& life) const;

  /// @returns whether the frame was SMEPP's
  bool accept_frame(const radio::frame& x, byte_view psdu) const;
  /// @param id of a request that has ended at the radio
  void on_sent(std::uint64_t id, const radio_done& x) const;
  /// @pre the mote has groups
  void on_time() const;
  void set_keys(const set_network_keys& x) const;

private:
  void perform(smepp::node_outputs todo) const;

  mote_pointer self_;
};

} // namespace rubicon
