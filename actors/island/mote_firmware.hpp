// The firmware of a mote: a shared library that has its radio, its sensors and its clock, and no
// layer between (docs/firmware.md).
#pragma once

#include <string>

#include "actors/island/mote_shell.hpp"
#include "core/bytes.hpp"

namespace rubicon {

/// Each but start() does nothing on a mote without firmware, and on one whose battery is flat.
class mote_firmware {
public:
  explicit mote_firmware(mote_pointer self) : self_(self) {}

  /// Starts it at once, if the mote has one; then and later what fails in it ends the mote by an
  /// exception. @param life names its random stream
  void start(const std::string& life) const;

  void on_frame(byte_view psdu, int rssi_dbm) const;
  /// @returns whether the request was of the firmware
  [[nodiscard]] bool on_done(const radio_done& x) const;
  void on_timer(const timer_expired& x) const;
  void move(position place) const;

  /// The power is lost for good.
  void stop() const;

  /// What it has counted; nothing without one.
  [[nodiscard]] report::cause_counts counted() const;

private:
  void begin() const;
  [[nodiscard]] firmware::session* running() const;
  void perform(firmware::outputs todo) const;
  void follow() const;

  mote_pointer self_;
};

} // namespace rubicon
