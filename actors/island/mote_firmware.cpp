#include "actors/island/mote_firmware.hpp"

#include <algorithm>
#include <utility>

#include "actors/base/log.hpp"
#include "actors/hosts/firmware_code.hpp"
#include "actors/messages/air.hpp"
#include "device/transducer.hpp"
#include "firmware/program_config.hpp"
#include "report/report.hpp"

namespace rubicon {

namespace {

constexpr std::size_t fcs_octets = 2;

// Below firmware_token a token has the number of the life and that of the frame.
constexpr unsigned starts_shift = 32;
constexpr std::uint64_t starts_mask = 0xfffff;

const firmware::program_config* config_of(mote_pointer self) {
  for (const auto& app : self->state.arguments->apps)
    if (const auto* x = std::get_if<firmware::program_config>(&app))
      return x->code ? x : nullptr;
  return nullptr;
}

/// What the firmware requests.
struct firmware_performer {
  mote_shell mote;

  void operator()(firmware::send_frame& x) const {
    const auto& arguments = *mote.state().arguments;
    mote.self->send(arguments.air,
                    radio_send_raw{arguments.radio, firmware_token | mote.state().firmware->sent++,
                                   payload(std::move(x.octets))});
  }
  void operator()(const firmware::switch_radio& x) const {
    auto demand = mote.state().radio;
    demand.stack = x.on;
    mote.set_radio(demand);
  }
  void operator()(const firmware::show_leds& x) const {
    log(mote.self, spdlog::level::debug, "event=leds on={}", x.on);
  }
  void operator()(const firmware::write_line& x) const {
    log(mote.self, spdlog::level::info, "event={} text=\"{}\"", x.serial ? "serial" : "log",
        x.text);
  }
};

firmware::outcome outcome_of(radio::send_status x) {
  switch (x) {
  case radio::send_status::sent:
    return RUBICON_MOTE_SENT;
  case radio::send_status::no_ack:
    return RUBICON_MOTE_NO_ACK;
  case radio::send_status::channel_access_failure:
  case radio::send_status::queue_full:
    return RUBICON_MOTE_BUSY;
  case radio::send_status::aborted:
    break;
  }
  return RUBICON_MOTE_OFF;
}

std::optional<std::int32_t> read_sensor(mote_pointer self, std::string_view name) {
  const auto& node = self->state.arguments->node;
  auto& shell = *self->state.firmware;
  const auto found = std::ranges::find_if(
      node.transducers, [name](const auto& x) { return device::to_string(x.kind) == name; });
  if (found == node.transducers.end())
    return {};
  return device::sample(*found, now(self), shell.noise, {shell.place, node.transducer_seed});
}

} // namespace

/// It is loaded in a turn of its own: what it throws is then a failure of the mote.
void mote_firmware::start(const std::string& life) const {
  auto& state = self_->state;
  const auto& of = *state.arguments;
  if (config_of(self_) == nullptr)
    return;
  state.firmware = std::make_unique<firmware_shell>();
  auto& shell = *state.firmware;
  shell.noise = random_stream(of.seed, life + "/firmware");
  shell.place = of.node.place;
  shell.sent = (state.store.starts & starts_mask) << starts_shift;
  shell.wake.follow(self_, now(self_));
}

void mote_firmware::begin() const {
  const auto& of = *self_->state.arguments;
  auto& shell = *self_->state.firmware;
  shell.runs = std::make_unique<firmware::session>(
      load_firmware(*config_of(self_)),
      firmware::identity{of.address.mote.value, static_cast<std::uint16_t>(of.address.island.value),
                         of.channel},
      random_stream(shell.noise.next()),
      [self = self_](std::string_view name) { return read_sensor(self, name); });
  perform(shell.runs->start(mote_shell{self_}.own_time()));
}

void mote_firmware::perform(firmware::outputs todo) const {
  for (auto& x : todo)
    std::visit(firmware_performer{{self_}}, x);
  follow();
}

void mote_firmware::follow() const {
  auto& state = self_->state;
  if (const auto due = state.firmware->runs->deadline())
    state.firmware->wake.follow(self_, std::max(now(self_), state.crystal.real(*due)));
  else
    state.firmware->wake.stop();
}

/// nullptr: nothing is to be called.
firmware::session* mote_firmware::running() const {
  const auto& shell = self_->state.firmware;
  return shell && !shell->is_stopped ? shell->runs.get() : nullptr;
}

void mote_firmware::on_frame(byte_view psdu, int rssi_dbm) const {
  if (auto* const runs = running(); runs != nullptr && psdu.size() > fcs_octets)
    perform(runs->on_frame(psdu.first(psdu.size() - fcs_octets), rssi_dbm,
                           mote_shell{self_}.own_time()));
}

bool mote_firmware::on_done(const radio_done& x) const {
  if (x.token >> 60U != 1)
    return false;
  auto* const runs = running();
  if (runs == nullptr)
    return true;
  const auto own = (firmware_token | self_->state.firmware->sent) >> starts_shift;
  if (x.token >> starts_shift == own && runs->open_frames() > 0) // else of an earlier life
    perform(runs->on_sent(outcome_of(x.status), mote_shell{self_}.own_time()));
  return true;
}

void mote_firmware::on_timer(const timer_expired& x) const {
  const auto& shell = self_->state.firmware;
  if (!shell || !shell->wake.accepts(x) || shell->is_stopped)
    return;
  if (shell->runs)
    perform(shell->runs->on_time(mote_shell{self_}.own_time()));
  else
    begin();
}

void mote_firmware::move(position place) const {
  if (const auto& shell = self_->state.firmware)
    shell->place = place;
}

void mote_firmware::stop() const {
  if (const auto& shell = self_->state.firmware) {
    shell->is_stopped = true;
    shell->wake.stop();
  }
}

report::cause_counts mote_firmware::counted() const {
  report::cause_counts all;
  if (const auto& shell = self_->state.firmware; shell && shell->runs)
    report::add_counters<firmware::session_counters>(all, "firmware", shell->runs->counters());
  return all;
}

} // namespace rubicon
