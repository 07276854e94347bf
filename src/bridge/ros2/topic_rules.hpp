// Which tuples are which topics, and which topics are which tuples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bridge/ros2/message_template.hpp"
#include "bridge/ros2/ros2_config.hpp"
#include "bridge/ros2/topic_outbox.hpp"
#include "core/component.hpp"

namespace rubicon::bridge {

/// What has become of a value.
enum class made : std::uint8_t {
  message, ///< it is published
  no_fit,  ///< it is not of the type
  no_room, ///< it is of a further topic, and there are topics_max
};

/// A topic that is published.
struct published_topic {
  std::string name;
  std::size_t rule = 0; ///< index of its rule
  std::size_t line = 0; ///< in the outbox
  std::string newest;   ///< message of a latched topic, whole; empty: none yet
};

class topic_rules {
public:
  static constexpr std::size_t topics_max = 1000; ///< that are published

  topic_rules() = default;
  explicit topic_rules(const ros2_config& config);

  struct value_result {
    made what = made::no_fit;
    bool is_new = false; ///< the topic has to be advertised
    const published_topic* topic = nullptr;
    std::string message; ///< whole, for the server
  };

  /// A value of the tuple. @param rule index of the publication
  [[nodiscard]] value_result on_value(std::size_t rule, const components::news& x, duration stamp,
                                      topic_outbox& outbox);
  void on_deleted(std::size_t rule, const components::news& x);

  /// All topics that are published.
  [[nodiscard]] const std::vector<published_topic>& published() const { return topics_; }
  [[nodiscard]] nlohmann::json advertisement(const published_topic& x) const;
  /// One for each topic of others that is listed.
  [[nodiscard]] std::vector<nlohmann::json> subscriptions() const;
  /// Indices of the subscriptions of this topic; nullptr: it is not listed.
  [[nodiscard]] const std::vector<std::size_t>* subscribed(std::string_view topic) const;

  /// Topics that have no blanks.
  void add_fixed(topic_outbox& outbox);

private:
  [[nodiscard]] std::optional<std::string> topic_of(std::size_t rule, std::string_view key) const;
  std::size_t add(std::string name, std::size_t rule, topic_outbox& outbox);

  std::vector<topic_publication> publications_;
  std::vector<topic_subscription> subscriptions_;
  std::vector<message_template> templates_; ///< of publications
  std::vector<published_topic> topics_;
  std::map<std::pair<std::string, std::size_t>, std::size_t> known_; ///< topics by name and rule
  std::map<std::string, std::vector<std::size_t>, std::less<>> by_topic_; ///< subscriptions
};

} // namespace rubicon::bridge
