#include "actors/bridge/mqtt_component.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "bridge/mqtt/simulated_component.hpp"
#include "core/overloads.hpp"
#include "core/text/host_port.hpp"
#include "io/files/secret_file.hpp"

namespace rubicon {

std::variant<io::mqtt_client_settings, std::string>
client_settings(const bridge::mqtt_settings& x) {
  const auto path_of = [&x](const std::string& file) {
    return file.empty() ? std::string() : (std::filesystem::path(x.folder) / file).string();
  };
  const auto& broker = x.broker;
  const auto where = parse_host_port(broker.address);
  if (!where)
    return x.place + ": " + broker.address + ": not HOST:PORT";
  io::mqtt_client_settings out;
  out.host = where->host;
  out.port = where->port;
  out.client = broker.client;
  out.user = broker.user;
  out.tls = broker.tls;
  out.authority = path_of(broker.authority);
  out.certificate = path_of(broker.certificate);
  out.key = path_of(broker.key);
  for (const auto* file : {&out.authority, &out.certificate})
    if (!file->empty() && !std::ifstream(*file).good()) // of which libmosquitto says nothing
      return x.place + ": " + *file + ": cannot be read";
  if (!out.key.empty()) {
    const auto key = io::read_secret(out.key); // libmosquitto reads it whoever has access to it
    if (const auto* why = std::get_if<io::no_secret>(&key))
      return x.place + ": " + why->reason;
  }
  if (broker.user.empty())
    return out;
  auto password = broker.password_file.empty()
                      ? io::secret_in_environment(bridge::password_variable)
                      : io::read_secret(path_of(broker.password_file));
  if (auto* why = std::get_if<io::no_secret>(&password))
    return x.place + ": " + why->reason +
           (broker.password_file.empty() ? ": set it, or give `password_file` beside `user`" : "");
  out.password = std::get<std::string>(std::move(password));
  return out;
}

mqtt_component::mqtt_component(bridge::mqtt_bridge core, io::mqtt_client_settings settings)
    : core_(std::move(core)), settings_(std::move(settings)) {}

components::outputs mqtt_component::perform(bridge::mqtt_outputs todo) {
  components::outputs out;
  for (auto& each : todo)
    std::visit(overloads{
                   [this](bridge::subscription& x) { client_->subscribe(std::move(x.topic)); },
                   [this](bridge::unsubscription& x) { client_->unsubscribe(std::move(x.topic)); },
                   [this](bridge::publication& x) {
                     client_->publish(std::move(x.topic), std::move(x.payload));
                   },
                   [&](components::publish& x) { out.emplace_back(std::move(x)); },
                   [&](components::write& x) { out.emplace_back(std::move(x)); },
               },
               each);
  return out;
}

components::outputs mqtt_component::start(instant /*now*/) {
  auto will = core_.last_will();
  settings_.will_topic = std::move(will.topic);
  settings_.will_payload = std::move(will.payload);
  client_ = std::make_unique<io::mqtt_client>(std::move(settings_), wake_);
  components::outputs out;
  for (auto& key : core_.watched())
    out.emplace_back(components::watch{0, any_peer, std::move(key)});
  return out;
}

components::outputs mqtt_component::on_input(instant now) {
  components::outputs out;
  const auto add = [&](bridge::mqtt_outputs todo) {
    auto more = perform(std::move(todo));
    std::move(more.begin(), more.end(), std::back_inserter(out));
  };
  for (auto& each : client_->take())
    std::visit(overloads{
                   [&](const io::mqtt_connected&) {
                     out.emplace_back(components::tell{"connected to the MQTT broker"});
                     add(core_.on_connected(now));
                   },
                   [&](const io::mqtt_disconnected& x) {
                     out.emplace_back(
                         components::tell{"not connected to the MQTT broker: " + x.cause});
                     core_.on_disconnected();
                   },
                   [&](const io::mqtt_message& x) {
                     add(core_.on_message({x.topic, x.payload, x.retained}, now));
                   },
               },
               each);
  return out;
}

components::outputs mqtt_component::on_tuple(const components::news& x, instant now) {
  return perform(core_.on_tuple(x, now));
}

components::outputs mqtt_component::on_written(std::uint64_t token, std::string_view cause,
                                               instant now) {
  return perform(core_.on_written(token, cause, now));
}

components::outputs mqtt_component::on_time(instant now) {
  return perform(core_.on_time(now));
}

components::figures mqtt_component::figures() const {
  auto out = bridge::figures_of(core_);
  if (client_)
    components::add_figures<io::mqtt_client_counters>(out, client_->counters(), "client ");
  return out;
}

} // namespace rubicon
