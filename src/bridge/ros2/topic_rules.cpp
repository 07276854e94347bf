#include "bridge/ros2/topic_rules.hpp"

#include <algorithm>
#include <chrono>

#include <nlohmann/json.hpp>

#include "bridge/ros2/message_types.hpp"
#include "core/text/json.hpp"
#include "translate/pattern.hpp"

namespace rubicon::bridge {

namespace {

/// The name of a topic with {1} replaced by the first of these parts.
std::string filled_topic(std::string_view topic, const std::vector<std::string>& parts) {
  std::string out;
  for (std::size_t i = 0; i < topic.size(); ++i) {
    if (topic[i] != '{') {
      out += topic[i];
      continue;
    }
    out += ros_part(parts.at(static_cast<std::size_t>(topic[i + 1] - '1')));
    i += 2;
  }
  return out;
}

} // namespace

topic_rules::topic_rules(const ros2_config& config)
    : publications_(config.publications), subscriptions_(config.subscriptions) {
  for (auto& each : publications_) {
    each.topic = absolute_name(config.name_space, each.topic);
    templates_.emplace_back(each.content.empty() ? "{}" : each.content);
  }
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    subscriptions_[i].topic = absolute_name(config.name_space, subscriptions_[i].topic);
    by_topic_[subscriptions_[i].topic].push_back(i);
  }
}

void topic_rules::add_fixed(topic_outbox& outbox) {
  for (std::size_t i = 0; i < publications_.size(); ++i)
    if (publications_[i].topic.find('{') == std::string::npos && topics_.size() < topics_max)
      add(publications_[i].topic, i, outbox);
}

std::size_t topic_rules::add(std::string name, std::size_t rule, topic_outbox& outbox) {
  const auto& of = publications_[rule];
  const auto at = topics_.size();
  known_.emplace(std::pair(name, rule), at);
  topics_.push_back({std::move(name), rule, outbox.add_topic({of.every, of.queue}), {}});
  return at;
}

std::optional<std::string> topic_rules::topic_of(std::size_t rule, std::string_view key) const {
  const auto parts = translate::match(publications_[rule].key, key);
  if (!parts)
    return std::nullopt;
  return filled_topic(publications_[rule].topic, *parts);
}

topic_rules::value_result topic_rules::on_value(std::size_t rule, const components::news& x,
                                                duration stamp, topic_outbox& outbox) {
  value_result out;
  auto name = topic_of(rule, x.key);
  if (!name)
    return out;
  const auto& of = publications_[rule];
  const message_source source{x.key, x.text, of.frame, of.scale, stamp};
  const auto message = of.content.empty()
                           ? message_of(of.type, source)
                           : templates_[rule].filled([&source](std::string_view blank) {
                               return value_of_blank(source, blank);
                             });
  if (!message)
    return out;
  auto found = known_.find({*name, rule});
  if (found == known_.end()) {
    if (topics_.size() >= topics_max) {
      out.what = made::no_room;
      return out;
    }
    add(*name, rule, outbox);
    found = known_.find({*name, rule});
    out.is_new = true;
  }
  auto& topic = topics_[found->second];
  const nlohmann::json whole{{"op", "publish"}, {"topic", topic.name}, {"msg", *message}};
  out.what = made::message;
  out.topic = &topic;
  out.message = json_line(whole);
  if (of.latch)
    topic.newest = out.message;
  return out;
}

/// What is not there any more is not sent to later subscribers.
void topic_rules::on_deleted(std::size_t rule, const components::news& x) {
  const auto name = topic_of(rule, x.key);
  if (!name)
    return;
  const auto found = known_.find({*name, rule});
  if (found != known_.end())
    topics_[found->second].newest.clear();
}

nlohmann::json topic_rules::advertisement(const published_topic& x) const {
  const auto& of = publications_[x.rule];
  return {{"op", "advertise"}, {"id", "advertise:" + x.name}, {"topic", x.name},
          {"type", of.type},   {"latch", of.latch},           {"queue_size", of.queue}};
}

std::vector<nlohmann::json> topic_rules::subscriptions() const {
  std::vector<nlohmann::json> out;
  for (const auto& [topic, rules] : by_topic_) {
    duration throttle = duration::max();
    std::uint32_t queue = 1;
    for (const auto i : rules) {
      throttle = std::min(throttle, subscriptions_[i].throttle);
      queue = std::max(queue, subscriptions_[i].queue);
    }
    out.push_back(
        {{"op", "subscribe"},
         {"id", "subscribe:" + topic},
         {"topic", topic},
         {"type", subscriptions_[rules.front()].type},
         {"throttle_rate", std::chrono::duration_cast<std::chrono::milliseconds>(throttle).count()},
         {"queue_length", queue}});
  }
  return out;
}

const std::vector<std::size_t>* topic_rules::subscribed(std::string_view topic) const {
  const auto found = by_topic_.find(topic);
  return found == by_topic_.end() ? nullptr : &found->second;
}

} // namespace rubicon::bridge
