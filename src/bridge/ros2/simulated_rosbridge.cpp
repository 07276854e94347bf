#include "bridge/ros2/simulated_rosbridge.hpp"

#include <nlohmann/json.hpp>

#include "bridge/table/payload.hpp"
#include "core/text/json.hpp"

namespace rubicon::bridge {

namespace {

std::string member_text(const nlohmann::json& x, const char* key) {
  const auto found = x.find(key);
  return found != x.end() && found->is_string() ? found->get<std::string>() : std::string();
}

nlohmann::json published(const std::string& name, nlohmann::json message) {
  return {{"op", "publish"}, {"topic", name}, {"msg", std::move(message)}};
}

} // namespace

simulated_rosbridge::texts simulated_rosbridge::on_text(std::string_view text) {
  texts out;
  const auto x = bounded_json(text);
  const auto operation = x.is_object() ? member_text(x, "op") : std::string();
  const auto name = x.is_object() ? member_text(x, "topic") : std::string();
  if (operation == "advertise" && !name.empty()) {
    auto& added = topics_[name];
    added.type = member_text(x, "type");
    added.latched = x.contains("latch") && x.at("latch") == true;
  } else if (operation == "subscribe" && !name.empty())
    subscribed_.insert(name);
  else if (operation == "publish" && topics_.contains(name) && x.contains("msg")) {
    auto& to = topics_[name];
    ++to.messages;
    to.newest = json_line(x.at("msg"));
    if (subscribed_.contains(name))
      out.push_back(json_line(published(name, x.at("msg"))));
  } else if (operation == "advertise_service")
    services_.insert(member_text(x, "service"));
  else if (operation == "service_response" && x.contains("values")) {
    if (answers_.size() < answers_max)
      answers_[member_text(x, "id")] = json_line(x.at("values"));
  } else if (operation == "call_service")
    out.push_back(json_line(nlohmann::json{{"op", "service_response"},
                                           {"id", member_text(x, "id")},
                                           {"service", member_text(x, "service")},
                                           {"values", "no such service"},
                                           {"result", false}}));
  else
    ++refused_;
  return out;
}

void simulated_rosbridge::on_disconnected() {
  topics_.clear();
  subscribed_.clear();
  services_.clear();
}

simulated_rosbridge::texts simulated_rosbridge::publish(const std::string& name,
                                                        const std::string& message) {
  if (!subscribed_.contains(name))
    return {};
  return {json_line(published(name, try_parse_json(message)))};
}

simulated_rosbridge::texts simulated_rosbridge::call(const std::string& service,
                                                     const std::string& id,
                                                     const std::string& arguments) {
  if (!services_.contains(service))
    return {};
  return {json_line(nlohmann::json{{"op", "call_service"},
                                   {"id", id},
                                   {"service", service},
                                   {"args", try_parse_json(arguments)}})};
}

} // namespace rubicon::bridge
