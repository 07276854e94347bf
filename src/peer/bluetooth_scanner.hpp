// Scans of one Bluetooth adapter for devices in reach (BT-04).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "core/time.hpp"
#include "io/bluetooth/bluetooth_adapter.hpp"
#include "io/bluetooth/packet_stream.hpp"
#include "io/loop.hpp"
#include "io/timer.hpp"
#include "peer/adapter_user.hpp"
#include "peis/bluetooth/bluetooth.hpp"

namespace rubicon::peer {

/// Requests an inquiry of the adapter's controller and collects what it reports:
///
///   idle --start()--> scanning --ended: on_scan(); refused, or not ended in time: counted--> idle
class bluetooth_scanner {
public:
  static constexpr std::size_t seen_max = 256; ///< devices of one scan; more are dropped
  static constexpr std::size_t room = std::size_t{64} * 1024; ///< octets for the controller

  /// @param name of the adapter, for its user
  /// @param where, adapter, user must outlive this
  bluetooth_scanner(io::loop& where, io::bluetooth_adapter& adapter, std::string name,
                    adapter_user& user);
  bluetooth_scanner(const bluetooth_scanner&) = delete;
  bluetooth_scanner& operator=(const bluetooth_scanner&) = delete;

  void start(duration length); ///< nothing while a scan is in progress
  void stop();                 ///< the user is not called of the present one

  [[nodiscard]] std::uint64_t failed() const { return failed_; }

private:
  void on_inquiry(byte_view packet);
  void end(bool success);

  io::loop* loop_;
  io::bluetooth_adapter* adapter_;
  std::string name_;
  adapter_user* user_;
  io::packet_stream controller_;
  io::timer end_;
  bool scanning_ = false;
  std::map<peis::bluetooth_address, int> seen_; ///< strengths of this scan, in dBm
  std::uint64_t failed_ = 0;
};

} // namespace rubicon::peer
