// HELLOs of one Bluetooth adapter: each is a connection of its own (BT-03, BT-05).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "io/bluetooth/bluetooth_adapter.hpp"
#include "io/bluetooth/packet_connect.hpp"
#include "io/bluetooth/packet_listener.hpp"
#include "io/bluetooth/packet_stream.hpp"
#include "io/loop.hpp"
#include "io/timer.hpp"
#include "peer/adapter_user.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/overlay/p2p_events.hpp"

namespace rubicon::peer {

struct bluetooth_hellos_config {
  std::string adapter;      ///< its name, for its user
  duration connect_timeout; ///< of ours
  duration answer_timeout;  ///< of ours once connected, and of one that has arrived
};

/// Sends ours, each with one answer, and takes in those of others, each with one question. Both end
/// after their time.
class bluetooth_hellos {
public:
  static constexpr std::size_t hellos_max = 16; ///< in each direction; more are dropped, counted
  static constexpr std::size_t room = std::size_t{64} * 1024; ///< octets that may wait in one

  /// @param where, adapter, user must outlive this
  bluetooth_hellos(io::loop& where, io::bluetooth_adapter& adapter, bluetooth_hellos_config config,
                   adapter_user& user);
  bluetooth_hellos(const bluetooth_hellos&) = delete;
  bluetooth_hellos& operator=(const bluetooth_hellos&) = delete;

  void listen(); ///< unless another process does at this adapter
  [[nodiscard]] bool listens() const { return listener_.has_value(); }

  void say(const peis::say_hello& x); ///< nothing while one to that device has no answer
  void answer(std::uint64_t number, bytes octets); ///< for one that is gone: nothing

  /// Ends all. The user is not called any more.
  void close();

  [[nodiscard]] std::uint64_t lost() const { return lost_; }

private:
  /// A HELLO that has arrived.
  struct arrived_hello {
    explicit arrived_hello(io::loop& where) : patience(where) {}
    io::packet_stream stream;
    io::timer patience;
    bool taken = false; ///< the user has it
  };
  /// One of ours, without answer so far.
  struct sent_hello {
    explicit sent_hello(io::loop& where) : patience(where) {}
    std::optional<io::packet_connect> attempt;
    io::packet_stream stream;
    io::timer patience;
  };

  void on_connection(io::descriptor x);
  void on_question(std::uint64_t number, byte_view octets);
  void send(const peis::bluetooth_address& to, const bytes& octets, io::descriptor connected);
  void end(const peis::bluetooth_address& to, byte_view answer);

  io::loop* loop_;
  io::bluetooth_adapter* adapter_;
  bluetooth_hellos_config config_;
  adapter_user* user_;
  std::optional<io::packet_listener> listener_;
  std::map<std::uint64_t, arrived_hello> arrived_;
  std::map<peis::bluetooth_address, sent_hello> sent_;
  std::uint64_t next_ = 1;
  std::uint64_t lost_ = 0;
};

} // namespace rubicon::peer
