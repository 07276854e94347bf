// The two sides of a firmware's interface: what a host calls, and what it is called for.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/bytes.hpp"
#include "firmware/rubicon_mote.h"

namespace rubicon::firmware {

using outcome = rubicon_mote_outcome;
using answer = rubicon_mote_result;

/// What a firmware may request while one of its functions runs; rubicon_mote_host says more.
class host {
public:
  host() = default;
  host(const host&) = delete;
  host& operator=(const host&) = delete;
  virtual ~host() = default;

  virtual answer send(byte_view frame) = 0;
  virtual void set_radio(bool on) = 0;
  virtual void set_timer(std::uint64_t at_us) = 0;
  virtual void write_serial(byte_view octets) = 0;
  virtual std::uint32_t draw() = 0;
  virtual std::optional<std::int32_t> read(std::string_view sensor) = 0;
  virtual void set_leds(unsigned on) = 0;
  virtual void log(std::string_view line) = 0;
};

/// What a mote is, for its firmware.
struct identity {
  std::uint16_t mote = 0;
  std::uint16_t island = 0;
  std::uint8_t channel = 0;
};

/// The functions of one mote's firmware. Each may throw: the firmware has failed.
class code {
public:
  code() = default;
  code(const code&) = delete;
  code& operator=(const code&) = delete;
  virtual ~code() = default;

  /// @param of outlives this
  virtual void init(const identity& who, host& of) = 0;
  virtual void run(std::uint64_t now_us) = 0;
  virtual void received(std::uint64_t now_us, byte_view frame, int rssi_dbm) = 0;
  virtual void sent(std::uint64_t now_us, outcome how) = 0;
};

} // namespace rubicon::firmware
