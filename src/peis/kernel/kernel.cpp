#include "peis/kernel/kernel.hpp"

#include <cassert>
#include <string>
#include <utility>

#include "peis/kernel/kernel_layers.hpp"
#include "peis/kernel/kernel_turn.hpp"

namespace rubicon::peis {

namespace {

constexpr std::string_view version_text = "v0.6.0.7 (proto 500)"; // what real kernels show

} // namespace

struct kernel::parts {
  parts() = default;
  parts(kernel_config config, random_stream rng, instant now)
      : layers(std::move(config), rng, now) {}

  [[nodiscard]] outputs finish(instant now) { return kernel_turn(layers, now).finish(); }

  kernel_layers layers;
  tuple_reader reader{layers};
  tuple_commands tuples{layers};
  subscription_commands subscriptions{layers};
  meta_commands meta_tuples{layers, tuples, reader};
  message_commands messages{layers};
};

kernel::kernel() : parts_(std::make_unique<parts>()) {}
kernel::~kernel() = default;
kernel::kernel(kernel&&) noexcept = default;
kernel& kernel::operator=(kernel&&) noexcept = default;

kernel::kernel(kernel_config config, random_stream rng, instant now)
    : parts_(std::make_unique<parts>(std::move(config), rng, now)) {
  auto& layers = parts_->layers;
  const auto& network = layers.config.network;
  assert(network.id.value >= 1 && network.id.value <= peer_id_max);
  const std::pair<std::string_view, std::string> published[] = {
      {"kernel.hostname", network.host_name}, {"kernel.version", std::string(version_text)},
      {"kernel.name", network.name},          {"kernel.user", layers.config.user},
      {"kernel.id", to_string(network.id)},   {quit_key, ""}};
  const auto statistics = [&] {
    return layers.statistics.initial(layers.network, layers.tuples, now);
  };
  kernel_turn turn(layers, now);
  turn.publish(statistics()); // there are no subscribers yet
  for (const auto& [name, text] : published)
    turn.publish({{*key::parse(name), text}});
  turn.publish(statistics()); // once more, all keys being there
}

tuple_commands& kernel::tuples() {
  return parts_->tuples;
}

subscription_commands& kernel::subscriptions() {
  return parts_->subscriptions;
}

meta_commands& kernel::meta_tuples() {
  return parts_->meta_tuples;
}

message_commands& kernel::messages() {
  return parts_->messages;
}

tuple_reader& kernel::reader() {
  return parts_->reader;
}

const tuple_reader& kernel::reader() const {
  return parts_->reader;
}

p2p_view kernel::network() const {
  return parts_->layers.network.view();
}

peer_id kernel::id() const {
  return parts_->layers.self();
}

kernel_counters kernel::counters() const {
  return parts_->layers.counters();
}

outputs kernel::on_link_open(link_id link, link_role role, instant now,
                             std::optional<attempt_id> attempt) {
  parts_->layers.network.on_link_open(link, role, now, attempt);
  return parts_->finish(now);
}

outputs kernel::on_attempt_failed(attempt_id attempt, instant now) {
  parts_->layers.network.on_attempt_failed(attempt, now);
  return parts_->finish(now);
}

outputs kernel::on_announcement(byte_view octets, instant now, std::optional<ipv4_address> from) {
  parts_->layers.network.on_announcement(octets, now, from);
  return parts_->finish(now);
}

outputs kernel::on_bluetooth_scan(std::string_view adapter, std::span<const seen_device> seen,
                                  instant now) {
  parts_->layers.network.on_bluetooth_scan(adapter, seen, now);
  return parts_->finish(now);
}

outputs kernel::on_hello_answer(std::string_view adapter, const bluetooth_address& address,
                                byte_view octets, instant now) {
  parts_->layers.network.on_hello_answer(adapter, address, octets, now);
  return parts_->finish(now);
}

outputs kernel::on_link_octets(link_id link, byte_view octets, instant now) {
  auto& network = parts_->layers.network;
  const bool idle = !network.has_input();
  network.on_link_octets(link, octets, now);
  kernel_turn turn(parts_->layers, now);
  return idle ? turn.finish_with_input() : turn.finish();
}

outputs kernel::on_link_sent(link_id link, std::size_t octets, instant now) {
  parts_->layers.network.on_link_sent(link, octets, now);
  return parts_->finish(now);
}

outputs kernel::on_link_closed(link_id link, instant now) {
  parts_->layers.network.on_link_closed(link, now);
  return parts_->finish(now);
}

outputs kernel::on_time(instant now) {
  auto& layers = parts_->layers;
  kernel_turn turn(layers, now);
  layers.network.on_time(now);
  turn.perform(layers.tuples.on_time(now));
  for (const auto request : layers.quits.take_refused(now))
    turn.report(request, cause::refused);
  return turn.finish_with_input();
}

std::optional<instant> kernel::deadline() const {
  const auto& x = parts_->layers;
  auto due = earliest(x.network.deadline(), x.tuples.deadline());
  due = earliest(due, x.quits.deadline());
  return earliest(due, x.statistics.deadline(x.tuples));
}

outputs kernel::step_clock(duration by, instant now) {
  parts_->layers.network.step_clock(by, now);
  return parts_->finish(now);
}

void kernel::note_step(duration length) {
  parts_->layers.statistics.note_step(length);
}

outputs kernel::set_addresses(std::vector<low_level_address> all, instant now) {
  parts_->layers.network.set_addresses(std::move(all), now);
  return parts_->finish(now);
}

outputs kernel::leave(instant now) {
  parts_->layers.network.leave();
  return parts_->finish(now);
}

} // namespace rubicon::peis
