// A rosbridge with topics and services, for runs in virtual time and for tests.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace rubicon::bridge {

/// One client is connected at most; nodes behind the server publish, subscribe and call by the
/// functions.
class simulated_rosbridge {
public:
  struct topic {
    std::string type;
    bool latched = false;
    std::string newest; ///< message as JSON
    std::uint64_t messages = 0;
  };

  /// What the server sends to its client.
  using texts = std::vector<std::string>;

  [[nodiscard]] texts on_text(std::string_view text);
  /// The client is gone: its topics, subscriptions and services are, too.
  void on_disconnected();

  /// A node publishes. @param message JSON
  [[nodiscard]] texts publish(const std::string& name, const std::string& message);
  /// A node calls a service of the client. @param arguments JSON
  [[nodiscard]] texts call(const std::string& service, const std::string& id,
                           const std::string& arguments);

  /// Topics that the client publishes, by name.
  [[nodiscard]] const std::map<std::string, topic>& topics() const { return topics_; }
  [[nodiscard]] const std::set<std::string>& subscriptions() const { return subscribed_; }
  [[nodiscard]] const std::set<std::string>& services() const { return services_; }
  /// Values of answers, as JSON, by id of the call.
  [[nodiscard]] const std::map<std::string, std::string>& answers() const { return answers_; }
  /// Messages that are not of the protocol, or of topics that are not advertised.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

private:
  static constexpr std::size_t answers_max = 1000;

  std::map<std::string, topic> topics_;
  std::set<std::string> subscribed_;
  std::set<std::string> services_;
  std::map<std::string, std::string> answers_;
  std::uint64_t refused_ = 0;
};

} // namespace rubicon::bridge
