// What carries out the commands of one program: the ports of its node's layer in the same actor
// (communication/direct_process.hpp), or messages to the node's actor
// (communication/remote_process.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "device/transducer_config.hpp"
#include "stream/events.hpp"
#include "synaptic/parameters.hpp"

namespace rubicon::communication {

/// What commands return, and events report.
enum class status : std::uint8_t { FAIL, SUCCESS };
using enum status;

[[nodiscard]] constexpr status status_of(bool success) {
  return success ? SUCCESS : FAIL;
}

/// An end of a remote stream that is to be opened.
struct stream_end {
  bool writes_to_self = false; ///< as in stream::remote_request
  mote_address other;
  std::uint16_t name = 0;
  std::uint32_t rate_ms = 0;
  std::uint8_t qos = 0;
  std::size_t buffer_size = stream::buffer_size_default;

  friend bool operator==(const stream_end&, const stream_end&) = default;
};
RUBICON_FIELDS(stream_end, writes_to_self, other, name, rate_ms, qos, buffer_size);

// The commands of communication/interface.hpp, one each. What the arguments alone show has been
// checked there.

class synaptic_commands {
public:
  synaptic_commands() = default;
  synaptic_commands(const synaptic_commands&) = delete;
  synaptic_commands& operator=(const synaptic_commands&) = delete;
  virtual ~synaptic_commands() = default;

  /// @returns a descriptor, or -1
  virtual int create(bool is_out, mote_address other, std::uint8_t size,
                     const synaptic::parameters& params) = 0;
  virtual status dispose(int channel) = 0;
  virtual status start(int channel) = 0;
  virtual status stop(int channel) = 0;
  virtual status write_output(int channel, std::uint8_t k, float value) = 0;
  virtual float read_input(int channel, std::uint8_t index) = 0;
};

class stream_commands {
public:
  stream_commands() = default;
  stream_commands(const stream_commands&) = delete;
  stream_commands& operator=(const stream_commands&) = delete;
  virtual ~stream_commands() = default;

  virtual int open_end(const stream_end& end) = 0;
  virtual int open_sensor(std::uint8_t transducer, std::uint32_t period_ms,
                          stream::sampling kind) = 0;
  virtual int open_local() = 0;
  virtual status close(int desc) = 0;
  virtual status read(int desc, std::size_t nbytes) = 0;
  virtual status write(int desc, byte_view record) = 0;
  [[nodiscard]] virtual bool has_ended(int desc) const = 0;
  [[nodiscard]] virtual std::optional<duration> latency_bound(int desc) const = 0;
};

class message_commands {
public:
  message_commands() = default;
  message_commands(const message_commands&) = delete;
  message_commands& operator=(const message_commands&) = delete;
  virtual ~message_commands() = default;

  virtual std::optional<std::uint32_t> send(mote_address to, byte_view octets, bool reliable,
                                            std::uint8_t am_type) = 0;
  virtual status provide(std::uint8_t am_type) = 0;
  virtual void hold(std::uint8_t am_type) = 0;
  virtual void release(std::uint8_t am_type) = 0;
};

/// Devices and membership of the node.
class node_commands {
public:
  node_commands() = default;
  node_commands(const node_commands&) = delete;
  node_commands& operator=(const node_commands&) = delete;
  virtual ~node_commands() = default;

  /// Counts a command that fails.
  virtual status refuse() = 0;

  virtual status read_transducers(std::span<const device::quantity> kinds) = 0;
  virtual status set_actuator(std::string_view name, std::uint8_t state) = 0;

  virtual status init() = 0;
  virtual status join(byte_view description) = 0;
  [[nodiscard]] virtual std::optional<mote_address> address() const = 0;
  [[nodiscard]] virtual instant now() const = 0;
  [[nodiscard]] virtual std::optional<duration> network_time() const = 0;

  virtual void leave() = 0;
};

/// One program's commands, by what they are about.
struct process {
  synaptic_commands& synaptic;
  stream_commands& streams;
  message_commands& messages;
  node_commands& node;
};

} // namespace rubicon::communication
