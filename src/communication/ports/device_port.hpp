// Transducers and actuators of a mote, as its programs use them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "communication/ports/local_node.hpp"
#include "communication/ports/program_list.hpp"
#include "communication/ports/stream_port.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "device/transducer_config.hpp"
#include "stream/sensor_record.hpp"

namespace rubicon::communication {

class device_port {
public:
  device_port(local_node& node, program_list& programs, stream_port& streams)
      : node_(node), programs_(programs), streams_(streams) {}

  // Commands of a program.
  status read_transducers(std::size_t program, std::span<const device::quantity> kinds);
  status set_actuator(std::size_t program, std::string_view name, std::uint8_t state);
  void leave(std::size_t program);

  /// Of a sensor stream.
  void on_sample(stream::descriptor stream, const stream::sensor_record& x, instant now);
  /// @param program that asked @param counts of all that it asked for
  void on_transducers(std::size_t program, std::vector<std::int16_t> counts, std::uint32_t time_ms,
                      instant now);
  /// @param program that asked @param state what it is now
  void on_actuator(std::size_t program, const std::string& name, std::uint8_t state, bool obeyed,
                   instant now);
  /// Notifies the program that has set it last. @param state what it is now
  void on_actuator_arrived(const std::string& name, std::uint8_t state, instant now);

private:
  local_node& node_;
  program_list& programs_;
  stream_port& streams_;
  small_map<std::string, std::size_t> last_setters_; ///< of actuators
};

} // namespace rubicon::communication
