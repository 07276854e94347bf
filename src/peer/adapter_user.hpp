// Who has a Bluetooth adapter.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/bytes.hpp"
#include "peis/bluetooth/bluetooth.hpp"

namespace rubicon::peer {

/// What it is notified of, beside its links. Called on the loop's thread, never from within a call
/// of bluetooth_links.
class adapter_user {
public:
  virtual ~adapter_user() = default;
  /// A scan has ended. @param seen ascending by address
  virtual void on_scan(const std::string& adapter, const std::vector<peis::seen_device>& seen) = 0;
  /// A HELLO has arrived, which answer_hello() answers. @param octets valid in the call
  virtual void on_hello(std::uint64_t number, byte_view octets) = 0;
  /// @param octets the answer, valid in the call; empty: there is none
  virtual void on_hello_answer(const std::string& adapter, const peis::bluetooth_address& device,
                               byte_view octets) = 0;
};

} // namespace rubicon::peer
