// Services of ROS that write tuples, and tuples that are requests to services of ROS.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bridge/ros2/message_template.hpp"
#include "bridge/ros2/ros2_config.hpp"
#include "core/component.hpp"
#include "core/describe/fields.hpp"

namespace rubicon::bridge {

/// A message for the server.
struct service_message {
  std::string text;
};

using ros2_service_output = std::variant<service_message, components::publish, components::write>;
using ros2_service_outputs = std::vector<ros2_service_output>;

/// calls = calls_succeeded + calls_failed + those that are open or lost with their connection, and
/// so for requests.
struct ros2_service_counters {
  std::uint64_t calls = 0; ///< of services that are offered
  std::uint64_t calls_succeeded = 0;
  std::uint64_t calls_failed = 0; ///< refused, failed, or without outcome
  std::uint64_t calls_lost = 0;   ///< the connection ended before they were answered
  std::uint64_t requests = 0;     ///< to services of others
  std::uint64_t requests_succeeded = 0;
  std::uint64_t requests_failed = 0; ///< also for want of a connection or an answer
};
RUBICON_FIELDS(ros2_service_counters, calls, calls_succeeded, calls_failed, calls_lost, requests,
               requests_succeeded, requests_failed);

/// A call of an offered service is written to its tuple, once, and answered when the outcome of
/// that value appears, the write fails, or its timeout is over. A request has one outcome tuple.
class ros2_services {
public:
  static constexpr std::size_t open_max = 256; ///< calls, and so many requests

  ros2_services() = default;
  explicit ros2_services(const ros2_config& config);

  /// @param first number of the first watch
  /// @param self whose kernel it uses
  [[nodiscard]] std::vector<components::watch> watched(std::uint64_t first, peer_id self) const;
  /// @param place of its watch: 0 for the first one
  [[nodiscard]] ros2_service_outputs on_tuple(std::size_t place, const components::news& x,
                                              duration stamp, instant now);
  [[nodiscard]] ros2_service_outputs on_written(std::uint64_t token, std::string_view cause);

  /// What is sent after each connection.
  [[nodiscard]] ros2_service_outputs on_connected();
  [[nodiscard]] ros2_service_outputs on_disconnected();
  /// @returns nothing if the service is not offered
  [[nodiscard]] std::optional<ros2_service_outputs> on_call(const nlohmann::json& x, instant now);
  [[nodiscard]] ros2_service_outputs on_response(const nlohmann::json& x);

  [[nodiscard]] ros2_service_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;
  [[nodiscard]] const ros2_service_counters& counters() const { return counters_; }

private:
  struct offer {
    offered_service rule;
    message_template content;
    std::optional<peer_id> owner; ///< of the tuple, once it is known
  };
  struct request {
    requested_service rule;
    message_template content;
  };
  struct open_call {
    std::size_t offer = 0;
    std::string id; ///< of the caller, as JSON
    std::string value;
    instant expires;
  };
  struct open_request {
    std::size_t request = 0;
    std::string value;
    instant expires;
  };

  void on_outcome(std::size_t at, std::string_view text, ros2_service_outputs& out);
  void call(std::size_t at, const components::news& x, duration stamp, instant now,
            ros2_service_outputs& out);
  void answer(std::size_t at, const std::string& id, bool success, std::string_view why,
              ros2_service_outputs& out);
  void end(const open_request& x, std::string_view outcome, ros2_service_outputs& out);

  std::vector<offer> offers_;
  std::vector<request> requests_;
  bool connected_ = false;
  std::map<std::uint64_t, open_call> calls_;      ///< by token
  std::map<std::uint64_t, open_request> waiting_; ///< by number
  std::uint64_t last_ = 0;                        ///< token or number
  ros2_service_counters counters_;
};

} // namespace rubicon::bridge
