#include "peis/bluetooth/hci_inquiry.hpp"

#include <algorithm>
#include <cstdint>

namespace rubicon::peis {

namespace {

constexpr std::uint8_t command_packet = 1;
constexpr std::uint8_t event_packet = 4;
constexpr duration inquiry_unit = 1280ms;

constexpr std::uint8_t inquiry_complete = 0x01;
constexpr std::uint8_t command_status = 0x0f;
constexpr std::uint8_t result_with_rssi = 0x22;
constexpr std::uint8_t extended_result = 0x2f;
constexpr std::uint8_t disallowed = 0x0c; ///< status: an inquiry of another program is in progress

constexpr std::size_t address_size = 6;
constexpr std::size_t rssi_at = 13;         ///< in a result; in old ones one octet further
constexpr std::size_t result_size_max = 15; ///< of old ones

/// The device of one result, whose signal strength is its octet `at`.
seen_device device_of(byte_view result, std::size_t at) {
  seen_device x;
  std::reverse_copy(result.begin(), result.begin() + address_size, x.address.octets.begin());
  x.strength_dbm = static_cast<std::int8_t>(result[at]);
  return x;
}

std::vector<seen_device> devices_of(byte_view results) {
  std::vector<seen_device> found;
  if (results.empty() || results[0] == 0)
    return found;
  const std::size_t count = results[0];
  results = results.subspan(1);
  const auto size = results.size() / count;
  if (size * count != results.size() || size <= rssi_at || size > result_size_max)
    return found;
  for (; !results.empty(); results = results.subspan(size))
    found.push_back(device_of(results, size - 1));
  return found;
}

} // namespace

bytes inquiry_command(duration length) {
  const auto units = std::clamp<std::int64_t>(length / inquiry_unit, 1, 48);
  return {command_packet,
          0x01,
          0x04, // opcode 0x0401
          5,
          0x33,
          0x8b,
          0x9e, // the general inquiry access code
          static_cast<std::uint8_t>(units),
          0};
}

inquiry_event decode_inquiry_event(byte_view packet) {
  constexpr std::size_t head = 3;
  if (packet.size() < head || packet[0] != event_packet || packet[2] != packet.size() - head)
    return {};
  const auto content = packet.subspan(head);
  const auto code = packet[1];
  if (code == inquiry_complete && content.size() == 1)
    return inquiry_ended{content[0] == 0};
  const bool is_refusal = code == command_status && content.size() == 4 && content[0] != 0 &&
                          content[0] != disallowed && content[2] == 0x01 && content[3] == 0x04;
  if (is_refusal)
    return inquiry_ended{false};
  if (code == result_with_rssi)
    return devices_of(content);
  if (code == extended_result && content.size() > rssi_at + 1 && content[0] == 1)
    return std::vector{device_of(content.subspan(1), rssi_at)};
  return {};
}

} // namespace rubicon::peis
