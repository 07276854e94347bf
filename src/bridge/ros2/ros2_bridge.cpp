#include "bridge/ros2/ros2_bridge.hpp"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "bridge/ros2/message_heading.hpp"
#include "bridge/ros2/message_types.hpp"
#include "bridge/table/payload.hpp"
#include "core/overloads.hpp"
#include "core/text/json.hpp"

namespace rubicon::bridge {

namespace {

constexpr const char* clock_topic = "/clock";
constexpr const char* clock_type = "rosgraph_msgs/msg/Clock";

/// The text that an object has there; empty if it has none.
std::string_view text_at(const nlohmann::json& x, const char* key) {
  const auto found = x.find(key);
  if (found == x.end() || !found->is_string())
    return {};
  return found->get_ref<const std::string&>();
}

} // namespace

ros2_bridge::ros2_bridge(ros2_config config, random_stream rng, duration epoch)
    : config_(std::move(config)), rng_(rng), epoch_(epoch), topics_(config_), services_(config_) {
  topics_.add_fixed(outbox_);
  clock_topic_ = outbox_.add_topic({});
}

std::vector<components::watch> ros2_bridge::watched(peer_id self) const {
  std::vector<components::watch> out;
  std::uint64_t number = 0;
  for (const auto& each : config_.publications)
    out.push_back({++number, any_peer, each.key});
  for (auto& each : services_.watched(number + 1, self))
    out.push_back(std::move(each));
  return out;
}

duration ros2_bridge::stamp(instant now) const {
  return now.time_since_epoch() + (config_.clock_every ? duration{} : epoch_);
}

void ros2_bridge::send(const nlohmann::json& x, ros2_outputs& out) {
  ++in_flight_;
  out.emplace_back(ros2_text{json_line(x)});
}

void ros2_bridge::perform(ros2_service_outputs todo, ros2_outputs& out) {
  for (auto& each : todo)
    std::visit(overloads{[&](service_message& x) {
                           if (!is_connected())
                             return;
                           ++in_flight_;
                           out.emplace_back(ros2_text{std::move(x.text)});
                         },
                         [&](auto& x) { out.emplace_back(std::move(x)); }},
               each);
}

void ros2_bridge::send_waiting(instant now, ros2_outputs& out) {
  if (!is_connected() || in_flight_ >= in_flight_max)
    return;
  for (auto& each : outbox_.take(in_flight_max - in_flight_, now)) {
    ++in_flight_;
    out.emplace_back(ros2_text{std::move(each)});
  }
}

ros2_outputs ros2_bridge::start(instant now) {
  retry_at_ = now;
  return on_time(now);
}

ros2_outputs ros2_bridge::on_tuple(const components::news& x, instant now) {
  ros2_outputs out;
  const auto rules = config_.publications.size();
  if (x.watch == 0)
    return out;
  if (x.watch > rules) {
    perform(services_.on_tuple(x.watch - rules - 1, x, stamp(now), now), out);
    return out;
  }
  if (x.deleted) {
    topics_.on_deleted(x.watch - 1, x);
    return out;
  }
  if (x.text.size() > payload_text_max) {
    ++counters_.bad_values;
    return out;
  }
  auto made_of = topics_.on_value(x.watch - 1, x, stamp(now), outbox_);
  if (made_of.what != made::message) {
    ++(made_of.what == made::no_fit ? counters_.bad_values : counters_.topics_full);
    return out;
  }
  if (!is_connected()) {
    ++counters_.unconnected;
    return out;
  }
  if (made_of.is_new)
    send(topics_.advertisement(*made_of.topic), out);
  ++counters_.published;
  outbox_.add(made_of.topic->line, std::move(made_of.message), now);
  send_waiting(now, out);
  return out;
}

ros2_outputs ros2_bridge::on_written(std::uint64_t token, std::string_view cause, instant /*now*/) {
  ros2_outputs out;
  perform(services_.on_written(token, cause), out);
  return out;
}

ros2_outputs ros2_bridge::on_connected(instant now) {
  ros2_outputs out;
  ++counters_.connections;
  state_ = state::open;
  retry_at_.reset();
  pause_.reset();
  in_flight_ = 0;
  if (config_.clock_every) {
    send({{"op", "advertise"}, {"topic", clock_topic}, {"type", clock_type}}, out);
    clock_at_ = now;
  }
  for (const auto& each : topics_.published())
    send(topics_.advertisement(each), out);
  for (const auto& each : topics_.subscriptions())
    send(each, out);
  perform(services_.on_connected(), out);
  for (const auto& each : topics_.published())
    if (!each.newest.empty()) {
      ++counters_.published;
      outbox_.add(each.line, each.newest, now);
    }
  send_waiting(now, out);
  return out;
}

ros2_outputs ros2_bridge::on_disconnected(instant now) {
  ros2_outputs out;
  ++counters_.failures;
  state_ = state::pausing;
  retry_at_ = now + pause_.next(rng_);
  clock_at_.reset();
  outbox_.clear();
  in_flight_ = 0;
  perform(services_.on_disconnected(), out);
  return out;
}

ros2_outputs ros2_bridge::on_text(std::string_view text, instant now) {
  ros2_outputs out;
  ++counters_.received;
  read_waiting(now, out); // they are older
  if (text.size() > message_max)
    ++counters_.oversized;
  else if (flood_.accepts(now))
    read(text, now, out);
  else {
    const auto topic = topic_of_publication(text);
    const bool is_value = topics_.subscribed(topic) != nullptr;
    counters_.flooded += !is_value || waiting_.keep(topic, text) ? 1 : 0;
  }
  send_waiting(now, out);
  return out;
}

void ros2_bridge::read(std::string_view text, instant now, ros2_outputs& out) {
  const auto parsed = bounded_json(text);
  if (!parsed.is_object())
    ++counters_.malformed;
  else
    on_operation(parsed, now, out);
}

void ros2_bridge::read_waiting(instant now, ros2_outputs& out) {
  if (waiting_.empty() || now < flood_.next())
    return;
  for (const auto& [topic, text] : waiting_.take()) {
    static_cast<void>(flood_.accepts(now)); // they count, and are fewer than the limit
    read(text, now, out);
  }
}

void ros2_bridge::on_operation(const nlohmann::json& x, instant now, ros2_outputs& out) {
  const auto operation = text_at(x, "op");
  if (operation == "publish")
    on_message(x, out);
  else if (operation == "call_service") {
    if (auto todo = services_.on_call(x, now))
      perform(*std::move(todo), out);
    else
      ++counters_.unlisted;
  } else if (operation == "service_response")
    perform(services_.on_response(x), out);
  else if (operation == "status")
    counters_.server_errors += text_at(x, "level") == "error" ? 1 : 0;
  else
    ++counters_.malformed;
}

void ros2_bridge::on_message(const nlohmann::json& x, ros2_outputs& out) {
  const auto* rules = topics_.subscribed(text_at(x, "topic"));
  const auto message = x.find("msg");
  if (rules == nullptr) {
    ++counters_.unlisted;
    return;
  }
  for (const auto i : *rules) {
    const auto& rule = config_.subscriptions[i];
    const auto text = message == x.end() ? std::nullopt : text_of_message(rule, *message);
    if (!text) {
      ++counters_.bad_messages;
      continue;
    }
    ++counters_.tuples_set;
    out.emplace_back(components::publish{rule.key, to_bytes(std::string_view(*text))});
  }
}

ros2_outputs ros2_bridge::on_sent(std::size_t count, instant now) {
  ros2_outputs out;
  in_flight_ -= std::min(in_flight_, count);
  send_waiting(now, out);
  return out;
}

void ros2_bridge::publish_clock(instant now) {
  if (!clock_at_ || *clock_at_ > now)
    return;
  clock_at_ = now + *config_.clock_every;
  ++counters_.clocks;
  const nlohmann::json message{{"op", "publish"},
                               {"topic", clock_topic},
                               {"msg", {{"clock", time_message(now.time_since_epoch())}}}};
  outbox_.add(clock_topic_, json_line(message), now);
}

ros2_outputs ros2_bridge::on_time(instant now) {
  ros2_outputs out;
  if (state_ == state::pausing && retry_at_ && *retry_at_ <= now) {
    retry_at_.reset();
    state_ = state::opening;
    out.emplace_back(open_connection{});
  }
  read_waiting(now, out);
  publish_clock(now);
  perform(services_.on_time(now), out);
  send_waiting(now, out);
  return out;
}

std::optional<instant> ros2_bridge::deadline() const {
  auto out = earliest(earliest(retry_at_, clock_at_), services_.deadline());
  if (!waiting_.empty())
    out = earliest(out, flood_.next());
  if (is_connected() && in_flight_ < in_flight_max)
    out = earliest(out, outbox_.deadline());
  return out;
}

components::figures figures_of(const ros2_bridge& x) {
  components::figures out;
  components::add_figures<bridge::ros2_counters>(out, x.counters());
  components::add_figures<bridge::ros2_service_counters>(out, x.services(), "services ");
  out.emplace_back("queue longest", static_cast<double>(x.outbox().longest()));
  out.emplace_back("queue dropped", static_cast<double>(x.outbox().dropped()));
  return out;
}

} // namespace rubicon::bridge
