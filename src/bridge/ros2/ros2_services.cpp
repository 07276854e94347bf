#include "bridge/ros2/ros2_services.hpp"

#include <charconv>
#include <utility>

#include <nlohmann/json.hpp>

#include "bridge/ros2/message_types.hpp"
#include "bridge/table/payload.hpp"
#include "core/text/json.hpp"

namespace rubicon::bridge {

namespace {

constexpr std::string_view set_bool = "std_srvs/srv/SetBool";
constexpr std::string_view request_begin = "request:";
constexpr std::size_t call_id_max = 256; ///< octets

service_message message_with(const nlohmann::json& x) {
  return {json_line(x)};
}

components::publish text_tuple(std::string key, std::string_view text) {
  return {std::move(key), to_bytes(text)};
}

/// What a call of the service writes; nothing if the request does not say.
std::optional<std::string> value_of_call(const offered_service& rule,
                                         const nlohmann::json& arguments) {
  if (!rule.value.empty())
    return rule.value;
  const bool is_flag = rule.member.empty();
  const auto* found = member_at(arguments, is_flag ? "data" : rule.member);
  if (found == nullptr || (is_flag && !found->is_boolean()))
    return std::nullopt;
  if (is_flag)
    return found->get<bool>() ? rule.on : rule.off;
  const auto word = word_in(*found);
  return word ? text_of(payload_type::text, *word) : std::nullopt;
}

bool is_success(std::string_view outcome) {
  return outcome == "acknowledged" || outcome == "sent" || outcome == "succeeded";
}

} // namespace

ros2_services::ros2_services(const ros2_config& config) {
  for (auto each : config.offers) {
    each.service = absolute_name(config.name_space, each.service);
    if (each.outcome.empty())
      each.outcome = each.key + ".outcome";
    message_template content(each.content.empty() ? R"({"success":"$success","message":"$message"})"
                                                  : each.content);
    offers_.push_back({std::move(each), std::move(content), {}});
  }
  for (auto each : config.requests) {
    each.service = absolute_name(config.name_space, each.service);
    const std::string_view standard = each.type == set_bool ? R"({"data":"$flag"})" : "{}";
    message_template content(each.content.empty() ? standard : std::string_view(each.content));
    requests_.push_back({std::move(each), std::move(content)});
  }
}

std::vector<components::watch> ros2_services::watched(std::uint64_t first, peer_id self) const {
  std::vector<components::watch> out;
  for (const auto& each : offers_) {
    out.push_back({first++, any_peer, each.rule.key});
    out.push_back({first++, any_peer, each.rule.outcome});
  }
  for (const auto& each : requests_)
    out.push_back({first++, self, each.rule.key});
  return out;
}

ros2_service_outputs ros2_services::on_tuple(std::size_t place, const components::news& x,
                                             duration stamp, instant now) {
  ros2_service_outputs out;
  if (place >= 2 * offers_.size()) {
    if (!x.deleted)
      call(place - 2 * offers_.size(), x, stamp, now, out);
    return out;
  }
  auto& of = offers_[place / 2];
  if (place % 2 == 0) {
    if (!x.deleted)
      of.owner = x.owner;
    else if (of.owner == x.owner)
      of.owner.reset();
  } else if (!x.deleted)
    on_outcome(place / 2, x.text, out);
  return out;
}

/// `on acknowledged`: the value, the last blank, what became of it.
void ros2_services::on_outcome(std::size_t at, std::string_view text, ros2_service_outputs& out) {
  const auto blank = text.rfind(' ');
  if (blank == std::string_view::npos)
    return;
  for (auto i = calls_.begin(); i != calls_.end();) {
    if (i->second.offer != at || i->second.value != text.substr(0, blank)) {
      ++i;
      continue;
    }
    const auto word = text.substr(blank + 1);
    answer(at, i->second.id, is_success(word), word, out);
    i = calls_.erase(i);
  }
}

void ros2_services::answer(std::size_t at, const std::string& id, bool success,
                           std::string_view why, ros2_service_outputs& out) {
  ++(success ? counters_.calls_succeeded : counters_.calls_failed);
  const auto& of = offers_[at];
  bool says_so = false;
  const auto values =
      of.content.filled([&](std::string_view blank) -> std::optional<nlohmann::json> {
        says_so |= blank == "success";
        return blank == "success" ? nlohmann::json(success) : nlohmann::json(why);
      });
  nlohmann::json x{{"op", "service_response"},
                   {"service", of.rule.service},
                   {"result", success || says_so},
                   {"values", values.value_or(nlohmann::json::object())}};
  if (!id.empty())
    x["id"] = try_parse_json(id);
  out.emplace_back(message_with(x));
}

void ros2_services::call(std::size_t at, const components::news& x, duration stamp, instant now,
                         ros2_service_outputs& out) {
  ++counters_.requests;
  const auto& of = requests_[at];
  open_request next{at, std::string(x.text.substr(0, payload_text_max)), now + of.rule.timeout};
  const message_source source{x.key, x.text, {}, 1, stamp};
  const auto arguments = of.content.filled(
      [&source](std::string_view blank) { return value_of_blank(source, blank); });
  if (!arguments || x.text.size() > payload_text_max || waiting_.size() >= open_max)
    return end(next, "failed", out);
  if (!connected_)
    return end(next, "unreachable", out);
  const auto number = ++last_;
  out.emplace_back(message_with({{"op", "call_service"},
                                 {"id", std::string(request_begin) + std::to_string(number)},
                                 {"service", of.rule.service},
                                 {"type", of.rule.type},
                                 {"args", *arguments}}));
  waiting_.emplace(number, std::move(next));
}

void ros2_services::end(const open_request& x, std::string_view outcome,
                        ros2_service_outputs& out) {
  ++(outcome == "succeeded" ? counters_.requests_succeeded : counters_.requests_failed);
  out.emplace_back(
      text_tuple(requests_[x.request].rule.key + ".outcome", x.value + ' ' + std::string(outcome)));
}

ros2_service_outputs ros2_services::on_written(std::uint64_t token, std::string_view cause) {
  ros2_service_outputs out;
  const auto found = calls_.find(token);
  if (found == calls_.end() || cause.empty())
    return out;
  answer(found->second.offer, found->second.id, false, cause, out);
  calls_.erase(found);
  return out;
}

ros2_service_outputs ros2_services::on_connected() {
  connected_ = true;
  ros2_service_outputs out;
  for (const auto& each : offers_)
    out.emplace_back(message_with(
        {{"op", "advertise_service"}, {"service", each.rule.service}, {"type", each.rule.type}}));
  return out;
}

ros2_service_outputs ros2_services::on_disconnected() {
  ros2_service_outputs out;
  connected_ = false;
  counters_.calls_lost += calls_.size();
  calls_.clear();
  for (const auto& [number, each] : std::exchange(waiting_, {}))
    end(each, "unreachable", out);
  return out;
}

std::optional<ros2_service_outputs> ros2_services::on_call(const nlohmann::json& x, instant now) {
  const auto service = x.find("service");
  if (service == x.end() || !service->is_string())
    return std::nullopt;
  std::size_t at = 0;
  while (at < offers_.size() && offers_[at].rule.service != *service)
    ++at;
  if (at == offers_.size())
    return std::nullopt;
  ++counters_.calls;
  ros2_service_outputs out;
  const auto given = x.find("id");
  auto id = given == x.end()
                ? std::string()
                : given->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (id.size() > call_id_max)
    id.clear();
  const auto arguments = x.find("args");
  const auto value =
      value_of_call(offers_[at].rule, arguments == x.end() ? nlohmann::json::object() : *arguments);
  const char* const why = !value                      ? "bad request"
                          : !offers_[at].owner        ? "no such tuple"
                          : calls_.size() >= open_max ? "too many calls"
                                                      : nullptr;
  if (why != nullptr) {
    answer(at, id, false, why, out);
    return out;
  }
  const auto token = ++last_;
  calls_[token] = {at, std::move(id), *value, now + offers_[at].rule.timeout};
  out.emplace_back(
      components::write{*offers_[at].owner, offers_[at].rule.key, *value, false, token});
  return out;
}

ros2_service_outputs ros2_services::on_response(const nlohmann::json& x) {
  ros2_service_outputs out;
  const auto id = x.find("id");
  if (id == x.end() || !id->is_string())
    return out;
  std::string_view text = id->get_ref<const std::string&>();
  if (!text.starts_with(request_begin))
    return out;
  text.remove_prefix(request_begin.size());
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  const auto found = waiting_.find(number);
  if (found == waiting_.end())
    return out;
  const auto result = x.find("result");
  const auto* success = member_at(x, "values.success");
  const bool good = result != x.end() && result->is_boolean() && result->get<bool>() &&
                    (success == nullptr || !success->is_boolean() || success->get<bool>());
  end(found->second, good ? "succeeded" : "failed", out);
  waiting_.erase(found);
  return out;
}

ros2_service_outputs ros2_services::on_time(instant now) {
  ros2_service_outputs out;
  std::erase_if(calls_, [&](const auto& each) {
    if (each.second.expires > now)
      return false;
    answer(each.second.offer, each.second.id, false, "timeout", out);
    return true;
  });
  std::erase_if(waiting_, [&](const auto& each) {
    if (each.second.expires > now)
      return false;
    end(each.second, "timeout", out);
    return true;
  });
  return out;
}

std::optional<instant> ros2_services::deadline() const {
  std::optional<instant> out;
  for (const auto& [token, each] : calls_)
    out = earliest(out, each.expires);
  for (const auto& [number, each] : waiting_)
    out = earliest(out, each.expires);
  return out;
}

} // namespace rubicon::bridge
