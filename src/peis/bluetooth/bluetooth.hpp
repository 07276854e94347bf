// What a peer knows over its Bluetooth adapters: which devices are near, and which of them are
// peers (D1.1 3.1.5.3, BT-01 to BT-06).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "peis/wire/link_url.hpp"

namespace rubicon::peis {

/// L2CAP port of HELLO connections (D1.1 3.1.5.3); decimal, as 0x7315 is no legal PSM.
inline constexpr std::uint16_t hello_port = bluetooth_port_default;

/// Whether this build has Bluetooth (RUBICON_BLUETOOTH, LNK-04). Without it adapters do nothing.
[[nodiscard]] bool has_bluetooth();

struct bluetooth_config {
  std::vector<std::string> adapters; ///< `hci0`, ...: only these are used (BT-01)
  duration scan_period = 10s;        ///< HELLOs go out after each scan
  int threshold_dbm = -67;           ///< to what is received more weakly no link is tried (BT-06)
  duration hello_timeout = 5s;
  duration hello_retry = 60s;    ///< a device that is no peer is asked again after this
  std::size_t devices_max = 256; ///< of each adapter; further ones are counted and passed over
};

struct seen_device {
  bluetooth_address address;
  int strength_dbm = 0;
};
RUBICON_FIELDS(seen_device, address, strength_dbm);

/// The adapter is to scan: the result comes to on_scan().
struct scan_adapter {
  std::string adapter;
};

/// A HELLO connection is wanted: the answer comes to on_answer().
struct ask_device {
  std::string adapter;
  bluetooth_address address;
};

/// The value of `kernel.ADAPTER.ADDRESS.str` (strength in dBm) or `.peis` (yes or no) is another;
/// nullopt: there is none any more.
struct device_noted {
  std::string key;
  std::optional<std::string> value;
};

/// Scans with all adapters at once, asks each device that is strong enough who it is, and keeps
/// what came of it for each adapter and device:
///
///   unknown --HELLO answered--> peer <--answered / failed--> no peer
///      +-------HELLO failed, or not answered in time------------^
///
/// Peers are asked again after each scan, others after hello_retry. What a scan does not find is
/// forgotten. Without adapters nothing ever happens.
class bluetooth {
public:
  enum class standing : std::uint8_t { unknown, peer, no_peer };
  using output = std::variant<scan_adapter, ask_device, device_noted>;
  using outputs = std::vector<output>;

  bluetooth() = default;
  bluetooth(bluetooth_config config, instant now);

  [[nodiscard]] outputs on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Ignored from adapters that are not ours.
  [[nodiscard]] outputs on_scan(std::string_view adapter, std::span<const seen_device> seen,
                                instant now);

  /// Ignored for devices out of sight. Late answers count.
  [[nodiscard]] outputs on_answer(std::string_view adapter, const bluetooth_address& address,
                                  bool is_peer, instant now);

  /// [bluetoothIsConnectable] At least as strong as the threshold at one of our adapters, and the
  /// last HELLO from there was answered.
  [[nodiscard]] bool is_connectable(const bluetooth_address& address) const;

  /// nullopt: out of sight.
  [[nodiscard]] std::optional<standing> standing_of(std::string_view adapter,
                                                    const bluetooth_address& address) const;

  [[nodiscard]] std::uint64_t passed_over() const { return passed_over_; }

private:
  struct device {
    int strength_dbm = 0;
    bluetooth::standing standing = bluetooth::standing::unknown;
    std::optional<instant> asked_until; ///< a HELLO is in flight
    instant next_hello;                 ///< not before
  };
  using device_map = std::map<bluetooth_address, device>;

  void settle(const std::string& adapter, const bluetooth_address& address, device& x, bool is_peer,
              instant now, outputs& out) const;
  void ask(const std::string& adapter, const bluetooth_address& address, device& x, instant now,
           outputs& out) const;

  bluetooth_config config_;
  std::map<std::string, device_map, std::less<>> adapters_;
  instant next_scan_;
  std::uint64_t passed_over_ = 0;
};

} // namespace rubicon::peis
