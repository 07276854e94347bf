#include "actors/services/gateway_report.hpp"

#include <utility>

#include "actors/base/statuses.hpp"
#include "actors/messages/supervision.hpp"

namespace rubicon {

namespace {

/// @param ends its life does
void report_real_line(gateway_pointer self, bool ends) {
  const auto& state = self->state;
  const auto& counted = state.plain.counters();
  real_line_status status{state.arguments.config.island, {}};
  auto& real = status.real;
  real.packets = counted.packets;
  real.taken = counted.taken;
  real.dropped = {counted.dropped.begin(), counted.dropped.end()};
  real.inputs = counted.inputs;
  real.inputs_sent = counted.inputs_sent;
  real.inputs_failed = {counted.inputs_failed.begin(), counted.inputs_failed.end()};
  if (ends && !state.inputs.empty())
    real.inputs_failed["gateway_ended"] += state.inputs.size();
  else
    real.inputs_open = state.inputs.size();
  self->send(state.arguments.ecology, std::move(status));
  if (!state.arguments.real_line)
    return;
  const auto& port = state.real_port.counters();
  const auto& frames = state.real_port.frames();
  serial_status line{state.arguments.config.island, {}};
  line.serial.frames_sent = port.attempts + port.acks_written;
  line.serial.frames_received = frames.good;
  line.serial.lost = {
      {"real_crc", frames.bad_crc + frames.too_short + frames.too_long + frames.aborted},
      {"real_no_ack", port.no_ack},
      {"real_queue_full", port.queue_full},
      {"real_refused", port.refused}};
  self->send(state.arguments.ecology, std::move(line));
}

/// @param ends its life does
void report_counters(gateway_pointer self, bool ends) {
  const auto& state = self->state;
  const auto island = state.arguments.config.island;
  const auto& ecology = state.arguments.ecology;
  const auto& pc = state.gateway.pc();
  const auto layer = pc.layer_counters();
  self->send(ecology, serial_status{island, counted(state)});
  if (!state.arguments.plain.motes.rules.empty() || state.plain.counters().packets > 0)
    report_real_line(self, ends);
  self->send(ecology,
             message_status{{island, no_mote},
                            false,
                            report_of(layer.transport, layer.layer, pc.outstanding(), ends)});
  state.programs.report(self, ecology, state.arguments.name, now(self), ends);
  report::cause_counts modules;
  report::add_counters<gateway::gateway_counters>(modules, "gateway", state.gateway.counters());
  report::add_counters<gateway::directory_counters>(modules, "directory",
                                                    state.gateway.others().counters());
  report::add_counters<transport::assembly_counters>(modules, "from_sink",
                                                     state.gateway.sink().fragments().counters());
  report::add_counters<communication::pc_counters>(modules, "pc", pc.counters());
  report::add_counters<serial::host_port_counters>(modules, "serial", state.port.counters());
  report::add_counters<serial::frame_counters>(modules, "frames", state.port.frames());
  report::add_counters<serial::host_port_counters>(modules, "real_serial",
                                                   state.real_port.counters());
  report::add_counters<serial::frame_counters>(modules, "real_frames", state.real_port.frames());
  report::add_counters<gateway::plain_line_counters>(modules, "plain_line", state.plain.counters());
  add_layer(modules, layer);
  send_modules(self, ecology, state.arguments.name, std::move(modules));
}

/// @param ends its life does, so it leads no more
void report_lead(gateway_pointer self, bool ends) {
  const auto& state = self->state;
  const auto& lead = state.gateway.lead();
  if (lead.alone())
    return;
  self->send(state.arguments.ecology,
             gateway_status{state.arguments.config.island,
                            id_of(self),
                            state.arguments.name,
                            {lead.led(), lead.leading(now(self)), lead.leads() && !ends}});
}

/// The motes that it lists, and its time.
void report_devices(gateway_pointer self) {
  const auto& gateway = self->state.gateway;
  if (!gateway.lead().leads())
    return;
  const auto offset = gateway.pc().clock_offset();
  self->send(self->state.arguments.ecology,
             devices_status{self->state.arguments.config.island, gateway.devices(),
                            offset.has_value(), offset.value_or(0s)});
}

} // namespace

peer_id id_of(gateway_pointer self) {
  const auto& arguments = self->state.arguments;
  return arguments.self == any_peer ? gateway_of(arguments.config.island) : arguments.self;
}

report::serial_report counted(const gateway_state& x) {
  const auto& port = x.port.counters();
  const auto& frames = x.port.frames();
  report::serial_report sum;
  sum.frames_sent = port.attempts + port.acks_written;
  sum.frames_received = frames.good;
  sum.lost = {{"gateway_crc", frames.bad_crc + frames.too_short + frames.too_long + frames.aborted},
              {"gateway_no_ack", port.no_ack},
              {"gateway_queue_full", port.queue_full},
              {"gateway_refused", port.refused},
              {"gateway_malformed", x.bad_packets}};
  return sum;
}

void report_gateway(gateway_pointer self) {
  report_counters(self, false);
  report_lead(self, false);
  report_devices(self);
}

void report_end(gateway_pointer self) {
  report_counters(self, true);
  report_lead(self, true);
}

} // namespace rubicon
