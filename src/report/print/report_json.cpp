#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "report/print/variation_json.hpp"
#include "report/report.hpp"

namespace rubicon::report {

namespace {

/// Keeps keys in the order written here, so that equal reports give equal text.
using json = nlohmann::ordered_json;

double at_s(instant x) {
  return seconds(x.time_since_epoch());
}

template <class T>
requires(std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) json value_of(const T& x) {
  return x;
}

/// An object even when nothing was counted.
json value_of(const cause_counts& x) {
  json object = json::object();
  for (const auto& [cause, count] : x)
    object[cause] = count;
  return object;
}

json value_of(duration x) {
  return seconds(x);
}

json value_of(instant x) {
  return at_s(x);
}

json value_of(mote_address x) {
  return to_string(x);
}

template <class Tag, class Rep>
json value_of(strong_id<Tag, Rep> x) {
  return x.value;
}

template <class T>
json value_of(const std::optional<T>& x) {
  return x ? json(*x) : json();
}

template <class T>
json value_of(const largest<T>& x) {
  return value_of(x.value);
}

template <class T>
constexpr bool is_time = std::is_same_v<T, duration> || std::is_same_v<T, instant> ||
                         std::is_same_v<T, largest<duration>>;

template <described T>
json to_json(const T& x);
json to_json(const message_report& x);

template <described T>
json value_of(const T& x) {
  return to_json(x);
}

/// Every field under its name, but one that the report calls otherwise; times in seconds, with `_s`
/// behind.
template <described T>
json to_json(const T& x, std::string_view field, std::string_view is_called) {
  json object = json::object();
  for_each_field(x, [&](std::string_view name, const auto& value) {
    using type = std::remove_cvref_t<decltype(value)>;
    object[std::string(name == field ? is_called : name) + (is_time<type> ? "_s" : "")] =
        value_of(value);
  });
  return object;
}

template <described T>
json to_json(const T& x) {
  return to_json(x, {}, {});
}

template <class T>
json with_delivery(const T& x) {
  auto object = to_json<T>(x);
  const auto delivery = x.delivery();
  object["delivery"] = delivery ? json(*delivery) : json();
  return object;
}

json to_json(const message_report& x) {
  return with_delivery(x);
}

json to_json(const stream_report& x) {
  return with_delivery(x);
}

json to_json(const flow_report& x) {
  auto object = to_json<flow_report>(x);
  if (x.to.mote == broadcast_mote)
    object["pdr"] = nullptr;
  return object;
}

json membership(const mote_report& x) {
  auto object = to_json(x, "address", "mote");
  object.erase("energy"); // has a part of its own
  return object;
}

json energy(const run_report& x) {
  json motes = json::array();
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes) {
      auto& each = motes.emplace_back(json{{"mote", to_string(mote.address)}});
      each.update(to_json(mote.energy));
    }
  return {{"used_mah", x.used_mah()}, {"motes", std::move(motes)}};
}

json clock(const clock_report& x) {
  auto object = to_json(x);
  const auto share = x.share_precise();
  object["share_precise"] = share ? json(*share) : json();
  return object;
}

json to_json(const gateway_report& x) {
  json object{{"peer", x.id.value}, {"name", x.name}};
  object.update(to_json(x.lead));
  return object;
}

/// What people call it, behind its name.
void add_label(json& object, const std::string& label) {
  if (!label.empty())
    object["label"] = label;
}

json to_json(const island_report& x, const config::label_table& labels) {
  using kind = config::label_table::kind;
  json motes = json::array();
  for (const auto& mote : x.motes) {
    motes.push_back(membership(mote));
    add_label(motes.back(), labels.of(kind::mote, x.name + '/' + mote.name));
  }
  json gateways = json::array();
  for (const auto& each : x.gateways)
    gateways.push_back(to_json(each));
  json all = {{"island", x.id.value},
              {"name", x.name},
              {"radio", to_json(x.radio)},
              {"serial", to_json(x.serial)},
              {"messages", to_json(x.messages)},
              {"network", to_json(x.network)},
              {"clock", clock(x.clock)},
              {"motes", std::move(motes)}};
  if (x.real.packets > 0 || x.real.inputs > 0)
    all["real"] = to_json(x.real);
  if (x.smepp.programs > 0) {
    all["smepp"] = to_json(x.smepp);
    all["smepp"]["events_missing"] = x.smepp.events_missing();
  }
  if (!x.gateways.empty())
    all["gateways"] = std::move(gateways);
  add_label(all, labels.of(kind::island, x.name));
  return all;
}

json to_json(const peer_report& x, const config::label_table& labels) {
  auto object = to_json(x, "id", "peer");
  object.erase("peis");
  object["packages"] = x.peis.packages;
  object["lost"] = value_of(x.peis.lost);
  add_label(object, labels.of(config::label_table::kind::peer, x.name));
  return object;
}

json to_json(const actuation_report& x) {
  return {{"requested", x.requested},
          {"acknowledged", x.acknowledged},
          {"sent", x.sent},
          {"latency_p50_s", latency_s(x, 0.5)},
          {"latency_p99_s", latency_s(x, 0.99)},
          {"slowest_s", seconds(x.slowest)},
          {"failed", value_of(x.failed)}};
}

json to_json(const proxy_report& x, const config::label_table& labels) {
  json values = json::object();
  for (const auto& [name, value] : x.values)
    values[name] = value;
  json object = {{"proxy", x.name},
                 {"class", x.proxy_class},
                 {"status", x.status},
                 {"values", std::move(values)},
                 {"latency_s", x.latency > 0s ? json(seconds(x.latency)) : json()},
                 {"late", x.late},
                 {"actuations", to_json(x.actuations)}};
  add_label(object, labels.of(config::label_table::kind::proxy, x.proxy_class));
  return object;
}

json to_json(const program_report& x) {
  json figures = json::object();
  for (const auto& [name, value] : x.figures)
    figures[name] = value;
  return {{"node", x.who}, {"program", x.kind}, {"figures", std::move(figures)}};
}

json to_json(const expectation_report& x) {
  return {{"expect", x.text},
          {"met", x.outcome == expectation_report::verdict::unjudged
                      ? json()
                      : json(x.outcome == expectation_report::verdict::met)},
          {"measured", x.measured},
          {"at_s", at_s(x.at)},
          {"command", x.command}};
}

template <class T>
json array_of(const std::vector<T>& elements) {
  json array = json::array();
  for (const auto& x : elements)
    array.push_back(to_json(x));
  return array;
}

template <class T>
json array_of(const std::vector<T>& elements, const config::label_table& labels) {
  json array = json::array();
  for (const auto& x : elements)
    array.push_back(to_json(x, labels));
  return array;
}

} // namespace

std::string to_json(const run_report& x) {
  return to_json(x, {});
}

std::string to_json(const run_report& x, const config::label_table& labels,
                    const config::variation& varied) {
  json object{
      {"ecology", x.ecology},
      {"seed", x.seed},
      {"mode", x.mode},
      {"simulated_s", seconds(x.simulated)},
      {"wall_s", x.wall_s},
      {"events", x.events},
      {"trace_hash", x.trace_hash},
      {"interrupted", x.interrupted},
      {"ended_by", x.ended_by},
      {"complete", x.complete},
      {"reason", x.reason},
      {"motes",
       {{"configured", x.motes_configured()},
        {"joined", x.motes_joined()},
        {"left", x.motes_left()},
        {"alive", x.motes_alive()},
        {"measuring", x.motes_measuring()}}},
      {"radio", to_json(x.radio())},
      {"serial", to_json(x.serial())},
      {"peis", to_json(x.peis())},
      {"messages", to_json(x.messages())},
      {"tunnels", to_json(x.tunnels)},
      {"losses", array_of(x.losses)},
      {"energy", energy(x)},
      {"actors",
       {{"spawned", x.actors.spawned},
        {"restarted", x.actors.restarted},
        {"failures", x.actors.failures},
        {"changes_refused", x.actors.changes_refused}}},
      {"islands", array_of(x.islands, labels)},
      {"peers", array_of(x.peers, labels)},
      {"proxies", array_of(x.proxies, labels)},
      {"flows", array_of(x.flows)},
      {"programs", array_of(x.programs)},
      {"modules", array_of(x.modules)},
      {"streams", array_of(x.streams)},
      {"expectations", array_of(x.expectations)},
      {"event_log", array_of(x.event_log)},
      {"event_log_left_out", x.event_log_left_out},
      {"violations", array_of(x.violations)},
  };
  if (!varied.empty())
    object["varied"] = variation_json(varied);
  // Names and values may come from outside the process: octets that are not UTF-8 are replaced.
  return printable_json(json_lines(object)) + '\n';
}

} // namespace rubicon::report
