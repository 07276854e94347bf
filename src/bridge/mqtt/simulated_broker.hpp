// An MQTT broker for runs in virtual time and for tests: retained messages, wills, wildcards.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/mqtt/publication_queue.hpp"

namespace rubicon::bridge {

/// Whether a topic filter of a subscription includes the topic (MQTT 3.1.1 section 4.7).
[[nodiscard]] bool filter_includes(std::string_view filter, std::string_view topic);

/// A message for one client.
struct brokered {
  std::uint32_t client = 0;
  std::string topic;
  std::string payload;
  bool retained = false;
};

/// Clients have clean sessions and quality of service 0: what is published while a client is not
/// connected is lost to it.
class simulated_broker {
public:
  using deliveries = std::vector<brokered>;

  /// @pre the client is not connected
  void connect(std::uint32_t client, publication last_will);
  /// The connection is closed without the client's request: its will is published.
  [[nodiscard]] deliveries lose(std::uint32_t client);
  /// @returns what is retained
  [[nodiscard]] deliveries subscribe(std::uint32_t client, const std::string& filter);
  void unsubscribe(std::uint32_t client, const std::string& filter);
  /// @param by the client, which does not receive it; 0: another one
  [[nodiscard]] deliveries publish(const publication& x, bool retain, std::uint32_t by = 0);

  /// All connections end.
  /// @param persistent what is retained is still there afterwards
  void restart(bool persistent);

  [[nodiscard]] const std::map<std::string, std::string>& retained() const { return retained_; }

private:
  struct session {
    publication last_will;
    std::vector<std::string> filters;
  };

  std::map<std::uint32_t, session> sessions_;
  std::map<std::string, std::string> retained_; ///< by topic
};

} // namespace rubicon::bridge
