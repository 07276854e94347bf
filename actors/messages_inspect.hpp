// CAF's inspect for every message, and the numbers CAF knows them by. Included by messages.hpp
// alone.
#pragma once

#include "actors/program_inspect.hpp"

namespace rubicon {

namespace runtime {

template <class F>
auto inspect(F& f, radio_report& x) {
  return f(caf::meta::type_name("radio_report"), x.sent, x.delivered, x.lost, x.requests,
           x.mac_sent, x.mac_failed, x.mac_open, x.transmissions);
}

template <class F>
auto inspect(F& f, serial_report& x) {
  return f(caf::meta::type_name("serial_report"), x.octets, x.octets_up, x.frames_sent,
           x.frames_received, x.lost);
}

template <class F>
auto inspect(F& f, peis_report& x) {
  return f(caf::meta::type_name("peis_report"), x.peers, x.packages, x.tuples, x.lost);
}

template <class F>
auto inspect(F& f, message_report& x) {
  return f(caf::meta::type_name("message_report"), x.reliable_sent, x.reliable_acked,
           x.reliable_failed, x.reliable_open, x.unreliable_sent, x.received, x.duplicates);
}

template <class F>
auto inspect(F& f, network_report& x) {
  return f(caf::meta::type_name("network_report"), x.beacons, x.packets, x.arrived, x.forwarded,
           x.repeated, x.channels_asked, x.channels_opened, x.channels_flooded, x.channels_broken,
           x.channel_packets, x.channel_packets_arrived, x.lost, x.hops_max, x.synchronised,
           x.clock_error_max, x.aligned, x.time_error_max, x.state_octets);
}

template <class F>
auto inspect(F& f, actuation_report& x) {
  return f(caf::meta::type_name("actuation_report"), x.requested, x.acknowledged, x.slowest,
           x.latency, x.failed);
}

template <class F>
auto inspect(F& f, proxy_report& x) {
  return f(caf::meta::type_name("proxy_report"), x.name, x.proxy_class, x.status, x.values,
           x.actuations);
}

template <class F>
auto inspect(F& f, program_report& x) {
  return f(caf::meta::type_name("program_report"), x.who, x.kind, x.figures);
}

template <class F>
auto inspect(F& f, peer_report& x) {
  return f(caf::meta::type_name("peer_report"), x.id, x.name, x.alive, x.incarnations, x.links,
           x.links_opened, x.links_closed, x.attempts, x.attempts_failed, x.hosts_known, x.cluster,
           x.tuples, x.peis, x.limits);
}

} // namespace runtime

namespace peis {

template <class F>
auto inspect(F& f, bluetooth_address& x) {
  return f(caf::meta::type_name("bluetooth_address"), x.octets);
}

template <class F>
auto inspect(F& f, seen_device& x) {
  return f(caf::meta::type_name("seen_device"), x.address, x.strength_dbm);
}

} // namespace peis

namespace flow {

template <class F>
auto inspect(F& f, part& x) {
  return f(caf::meta::type_name("part"), x.from, x.to, x.sent, x.delivered, x.octets,
           x.transmissions, x.lost, x.active, x.delay);
}

} // namespace flow

template <class F>
auto inspect(F& f, timer_expired& x) {
  return f(caf::meta::type_name("timer_expired"), x.which, x.epoch);
}

template <class F>
auto inspect(F& f, status_request&) {
  return f(caf::meta::type_name("status_request"));
}

template <class F>
auto inspect(F& f, story& x) {
  return f(caf::meta::type_name("story"), x.who, x.what);
}

template <class F>
auto inspect(F& f, actor_failed& x) {
  return f(caf::meta::type_name("actor_failed"), x.who, x.why);
}

template <class F>
auto inspect(F& f, request_unmet& x) {
  return f(caf::meta::type_name("request_unmet"), x.who, x.what, x.ends_run);
}

template <class F>
auto inspect(F& f, mote_flat& x) {
  return f(caf::meta::type_name("mote_flat"), x.mote);
}

template <class F>
auto inspect(F& f, listing_changed& x) {
  return f(caf::meta::type_name("listing_changed"), x.mote, x.listed, x.incarnation, x.cause);
}

template <class F>
auto inspect(F& f, radio_status& x) {
  return f(caf::meta::type_name("radio_status"), x.island, x.radio);
}

template <class F>
auto inspect(F& f, energy_status& x) {
  return f(caf::meta::type_name("energy_status"), x.mote, x.used_mah, x.battery_mah);
}

template <class F>
auto inspect(F& f, store_written& x) {
  return f(caf::meta::type_name("store_written"), x.mote, x.content.starts, x.content.term);
}

template <class F>
auto inspect(F& f, radio_left& x) {
  return f(caf::meta::type_name("radio_left"), x.energy);
}

template <class F>
auto inspect(F& f, flow_status& x) {
  return f(caf::meta::type_name("flow_status"), x.parts);
}

template <class F>
auto inspect(F& f, network_status& x) {
  return f(caf::meta::type_name("network_status"), x.address, x.is_sink, x.has_clock,
           x.clock_ahead_us, x.has_network_time, x.network_ahead_us, x.network);
}

template <class F>
auto inspect(F& f, message_status& x) {
  return f(caf::meta::type_name("message_status"), x.who.island, x.messages);
}

template <class F>
auto inspect(F& f, serial_status& x) {
  return f(caf::meta::type_name("serial_status"), x.island, x.serial);
}

template <class F>
auto inspect(F& f, devices_status& x) {
  return f(caf::meta::type_name("devices_status"), x.island, x.listed, x.has_clock, x.clock_offset);
}

template <class F>
auto inspect(F& f, gateway_status& x) {
  return f(caf::meta::type_name("gateway_status"), x.island, x.gateway.id, x.gateway.name,
           x.gateway.led, x.gateway.leading, x.gateway.leads);
}

template <class F>
auto inspect(F& f, gateway_changed& x) {
  return f(caf::meta::type_name("gateway_changed"), x.gateway, x.name);
}

template <class F>
auto inspect(F& f, peer_status& x) {
  return f(caf::meta::type_name("peer_status"), x.peer, x.hosts, x.neighbours);
}

template <class F>
auto inspect(F& f, program_status& x) {
  return f(caf::meta::type_name("program_status"), x.program);
}

template <class F>
auto inspect(F& f, sample_status& x) {
  return f(caf::meta::type_name("sample_status"), x.sample, x.who, x.address, x.is_sink,
           x.has_clock, x.clock_ahead_us, x.missed);
}

template <class F>
auto inspect(F& f, take_sample&) {
  return f(caf::meta::type_name("take_sample"));
}

template <class F>
auto inspect(F& f, proxy_status& x) {
  return f(caf::meta::type_name("proxy_status"), x.proxy);
}

template <class F>
auto inspect(F& f, frame_received& x) {
  return f(caf::meta::type_name("frame_received"), x.psdu, x.rssi_dbm);
}

template <class F>
auto inspect(F& f, radio_done& x) {
  return f(caf::meta::type_name("radio_done"), x.token, x.status, x.transmissions, x.arrived,
           x.last);
}

template <class F>
auto inspect(F& f, battery_low&) {
  return f(caf::meta::type_name("battery_low"));
}

template <class F>
auto inspect(F& f, battery_flat&) {
  return f(caf::meta::type_name("battery_flat"));
}

template <class F>
auto inspect(F& f, attach_radio& x) {
  return f(caf::meta::type_name("attach_radio"), x.radio, x.user);
}

template <class F>
auto inspect(F& f, radio_send& x) {
  return f(caf::meta::type_name("radio_send"), x.radio, x.token, x.destination, x.am_type, x.octets,
           x.ack, x.age_at, x.in_slot);
}

template <class F>
auto inspect(F& f, radio_power& x) {
  return f(caf::meta::type_name("radio_power"), x.radio, x.state);
}

template <class F>
auto inspect(F& f, make_noise& x) {
  return f(caf::meta::type_name("make_noise"), x.from, x.duty, x.burst, x.length);
}

template <class F>
auto inspect(F& f, lose_frames& x) {
  return f(caf::meta::type_name("lose_frames"), x.everywhere, x.island, x.loss, x.length);
}

template <class F>
auto inspect(F& f, carry_away& x) {
  return f(caf::meta::type_name("carry_away"), x.radio);
}

template <class F>
auto inspect(F& f, bring_radio& x) {
  return f(caf::meta::type_name("bring_radio"), x.radio, x.used_mah);
}

template <class F>
auto inspect(F& f, move_radio& x) {
  return f(caf::meta::type_name("move_radio"), x.radio, x.place);
}

template <class F>
auto inspect(F& f, move_mote& x) {
  return f(caf::meta::type_name("move_mote"), x.place);
}

template <class F>
auto inspect(F& f, serial_octets& x) {
  return f(caf::meta::type_name("serial_octets"), x.octets);
}

template <class F>
auto inspect(F& f, attach_serial& x) {
  return f(caf::meta::type_name("attach_serial"), x.towards, x.user);
}

template <class F>
auto inspect(F& f, serial_write& x) {
  return f(caf::meta::type_name("serial_write"), x.towards, x.octets);
}

template <class F>
auto inspect(F& f, plug_serial& x) {
  return f(caf::meta::type_name("plug_serial"), x.plugged);
}

template <class F>
auto inspect(F& f, membership_changed& x) {
  return f(caf::meta::type_name("membership_changed"), x.joined, x.island);
}

template <class F>
auto inspect(F& f, message_received& x) {
  return f(caf::meta::type_name("message_received"), x.source, x.am_type, x.octets);
}

template <class F>
auto inspect(F& f, send_ended& x) {
  return f(caf::meta::type_name("send_ended"), x.token, x.refused, x.acked);
}

template <class F>
auto inspect(F& f, transducers_read& x) {
  return f(caf::meta::type_name("transducers_read"), x.counts, x.time_ms);
}

template <class F>
auto inspect(F& f, actuator_changed& x) {
  return f(caf::meta::type_name("actuator_changed"), x.name, x.state, x.obeyed);
}

template <class F>
auto inspect(F& f, outputs_wanted& x) {
  return f(caf::meta::type_name("outputs_wanted"), x.all);
}

template <class F>
auto inspect(F& f, claim_am_type& x) {
  return f(caf::meta::type_name("claim_am_type"), x.app, x.am_type);
}

template <class F>
auto inspect(F& f, send_message& x) {
  return f(caf::meta::type_name("send_message"), x.app, x.token, x.destination, x.am_type, x.octets,
           x.reliable);
}

template <class F>
auto inspect(F& f, read_transducers& x) {
  return f(caf::meta::type_name("read_transducers"), x.app, x.kinds);
}

template <class F>
auto inspect(F& f, set_actuator& x) {
  return f(caf::meta::type_name("set_actuator"), x.app, x.name, x.state);
}

template <class F>
auto inspect(F& f, program_attached& x) {
  return f(caf::meta::type_name("program_attached"), x.limits, x.incarnation);
}

template <class F>
auto inspect(F& f, program_detached&) {
  return f(caf::meta::type_name("program_detached"));
}

template <class F>
auto inspect(F& f, program_events& x) {
  return f(caf::meta::type_name("program_events"), x.batch);
}

template <class F>
auto inspect(F& f, attach_program& x) {
  return f(caf::meta::type_name("attach_program"), x.number, x.program);
}

template <class F>
auto inspect(F& f, program_commands& x) {
  return f(caf::meta::type_name("program_commands"), x.number, x.batch);
}

template <class F>
auto inspect(F& f, mote_started& x) {
  return f(caf::meta::type_name("mote_started"), x.mote);
}

template <class F>
auto inspect(F& f, restart_program& x) {
  return f(caf::meta::type_name("restart_program"), x.mote, x.number);
}

template <class F>
auto inspect(F& f, crash_now&) {
  return f(caf::meta::type_name("crash_now"));
}

template <class F>
auto inspect(F& f, end_battery&) {
  return f(caf::meta::type_name("end_battery"));
}

template <class F>
auto inspect(F& f, link_octets& x) {
  return f(caf::meta::type_name("link_octets"), x.link, x.octets);
}

template <class F>
auto inspect(F& f, link_closed& x) {
  return f(caf::meta::type_name("link_closed"), x.link);
}

template <class F>
auto inspect(F& f, link_condition& x) {
  return f(caf::meta::type_name("link_condition"), x.cut, x.loss);
}

template <class F>
auto inspect(F& f, link_opened& x) {
  return f(caf::meta::type_name("link_opened"), x.link, x.other, x.initiator, x.attempt,
           x.condition);
}

template <class F>
auto inspect(F& f, condition_changed& x) {
  return f(caf::meta::type_name("condition_changed"), x.link, x.condition);
}

template <class F>
auto inspect(F& f, attempt_failed& x) {
  return f(caf::meta::type_name("attempt_failed"), x.attempt);
}

template <class F>
auto inspect(F& f, announcement& x) {
  return f(caf::meta::type_name("announcement"), x.octets);
}

template <class F>
auto inspect(F& f, link_sent& x) {
  return f(caf::meta::type_name("link_sent"), x.link, x.octets);
}

template <class F>
auto inspect(F& f, join_lan& x) {
  return f(caf::meta::type_name("join_lan"), x.station, x.id, x.hears, x.user);
}

template <class F>
auto inspect(F& f, lan_connect& x) {
  return f(caf::meta::type_name("lan_connect"), x.station, x.attempt, x.to);
}

template <class F>
auto inspect(F& f, lan_announce& x) {
  return f(caf::meta::type_name("lan_announce"), x.station, x.octets);
}

template <class F>
auto inspect(F& f, lan_link_ended& x) {
  return f(caf::meta::type_name("lan_link_ended"), x.link);
}

template <class F>
auto inspect(F& f, set_lan_power& x) {
  return f(caf::meta::type_name("set_lan_power"), x.station, x.on);
}

template <class F>
auto inspect(F& f, begin_lan_fault& x) {
  return f(caf::meta::type_name("begin_lan_fault"), x.fault, x.groups, x.loss, x.lossy);
}

template <class F>
auto inspect(F& f, end_lan_fault& x) {
  return f(caf::meta::type_name("end_lan_fault"), x.fault);
}

template <class F>
auto inspect(F& f, bluetooth_seen& x) {
  return f(caf::meta::type_name("bluetooth_seen"), x.adapter, x.devices);
}

template <class F>
auto inspect(F& f, hello_answer& x) {
  return f(caf::meta::type_name("hello_answer"), x.adapter, x.device, x.octets);
}

template <class F>
auto inspect(F& f, hello_arrived& x) {
  return f(caf::meta::type_name("hello_arrived"), x.question, x.sender);
}

template <class F>
auto inspect(F& f, bluetooth_opened& x) {
  return f(caf::meta::type_name("bluetooth_opened"), x.link, x.rate_bps);
}

template <class F>
auto inspect(F& f, join_bluetooth& x) {
  return f(caf::meta::type_name("join_bluetooth"), x.station, x.machine, x.adapters, x.place,
           x.port, x.user);
}

template <class F>
auto inspect(F& f, scan_bluetooth& x) {
  return f(caf::meta::type_name("scan_bluetooth"), x.station, x.adapter);
}

template <class F>
auto inspect(F& f, send_hello& x) {
  return f(caf::meta::type_name("send_hello"), x.station, x.question);
}

template <class F>
auto inspect(F& f, bluetooth_connect& x) {
  return f(caf::meta::type_name("bluetooth_connect"), x.station, x.attempt, x.to, x.port);
}

template <class F>
auto inspect(F& f, move_machine& x) {
  return f(caf::meta::type_name("move_machine"), x.machine, x.place);
}

template <class F>
auto inspect(F& f, pause_peer& x) {
  return f(caf::meta::type_name("pause_peer"), x.length);
}

template <class F>
auto inspect(F& f, resume_peer&) {
  return f(caf::meta::type_name("resume_peer"));
}

template <class F>
auto inspect(F& f, step_clock& x) {
  return f(caf::meta::type_name("step_clock"), x.by);
}

template <class F>
auto inspect(F& f, leave_network&) {
  return f(caf::meta::type_name("leave_network"));
}

template <class F>
auto inspect(F& f, restart_peer& x) {
  return f(caf::meta::type_name("restart_peer"), x.name);
}

template <class F>
auto inspect(F& f, end_duplicate& x) {
  return f(caf::meta::type_name("end_duplicate"), x.name);
}

template <class F>
auto inspect(F& f, end_run&) {
  return f(caf::meta::type_name("end_run"));
}

template <class F>
auto inspect(F& f, tuple_event& x) {
  return f(caf::meta::type_name("tuple_event"), x.watch, x.owner, x.key, x.value, x.deleted);
}

template <class F>
auto inspect(F& f, peis_message& x) {
  return f(caf::meta::type_name("peis_message"), x.source, x.port, x.octets);
}

template <class F>
auto inspect(F& f, peis_outcome& x) {
  return f(caf::meta::type_name("peis_outcome"), x.token, x.success, x.cause);
}

template <class F>
auto inspect(F& f, set_tuple& x) {
  return f(caf::meta::type_name("set_tuple"), x.key, x.value, x.text);
}

template <class F>
auto inspect(F& f, delete_tuple& x) {
  return f(caf::meta::type_name("delete_tuple"), x.key);
}

template <class F>
auto inspect(F& f, set_remote_tuple& x) {
  return f(caf::meta::type_name("set_remote_tuple"), x.client, x.token, x.owner, x.key, x.value,
           x.text);
}

template <class F>
auto inspect(F& f, declare_meta_tuple& x) {
  return f(caf::meta::type_name("declare_meta_tuple"), x.key, x.reference);
}

template <class F>
auto inspect(F& f, set_meta_tuple& x) {
  return f(caf::meta::type_name("set_meta_tuple"), x.client, x.token, x.owner, x.key, x.reference);
}

template <class F>
auto inspect(F& f, watch_indirectly& x) {
  return f(caf::meta::type_name("watch_indirectly"), x.client, x.watch, x.owner, x.key);
}

template <class F>
auto inspect(F& f, watch_tuples& x) {
  return f(caf::meta::type_name("watch_tuples"), x.client, x.watch, x.owner, x.key);
}

template <class F>
auto inspect(F& f, subscribers_changed& x) {
  return f(caf::meta::type_name("subscribers_changed"), x.keys);
}

template <class F>
auto inspect(F& f, watch_subscribers& x) {
  return f(caf::meta::type_name("watch_subscribers"), x.watcher, x.first_part);
}

template <class F>
auto inspect(F& f, clock_changed& x) {
  return f(caf::meta::type_name("clock_changed"), x.offset);
}

template <class F>
auto inspect(F& f, watch_clock& x) {
  return f(caf::meta::type_name("watch_clock"), x.watcher);
}

template <class F>
auto inspect(F& f, broadcast_peis_message& x) {
  return f(caf::meta::type_name("broadcast_peis_message"), x.port, x.octets);
}

template <class F>
auto inspect(F& f, hook_port& x) {
  return f(caf::meta::type_name("hook_port"), x.client, x.port);
}

template <class F>
auto inspect(F& f, send_peis_message& x) {
  return f(caf::meta::type_name("send_peis_message"), x.client, x.token, x.destination, x.port,
           x.octets, x.reliable);
}

template <class F>
auto inspect(F& f, start_component& x) {
  return f(caf::meta::type_name("start_component"), x.peer, x.life);
}

template <class F>
auto inspect(F& f, stop_component& x) {
  return f(caf::meta::type_name("stop_component"), x.peer, x.at_once);
}

template <class F>
auto inspect(F& f, quit_peer&) {
  return f(caf::meta::type_name("quit_peer"));
}

template <class F>
auto inspect(F& f, component_started& x) {
  return f(caf::meta::type_name("component_started"), x.peer, x.life);
}

template <class F>
auto inspect(F& f, component_ended& x) {
  return f(caf::meta::type_name("component_ended"), x.peer, x.life);
}

template <class F>
auto inspect(F& f, kernel_guarded& x) {
  return f(caf::meta::type_name("kernel_guarded"), x.host_name, x.network, x.port);
}

template <class F>
auto inspect(F& f, quit_wanted&) {
  return f(caf::meta::type_name("quit_wanted"));
}

template <class F>
auto inspect(F& f, process_output& x) {
  return f(caf::meta::type_name("process_output"), x.component, x.is_error, x.octets);
}

template <class F>
auto inspect(F& f, process_ended& x) {
  return f(caf::meta::type_name("process_ended"), x.component, x.life, x.how);
}

template <class F>
auto inspect(F& f, guard_kernel& x) {
  return f(caf::meta::type_name("guard_kernel"), x.init);
}

template <class F>
auto inspect(F& f, mote_presence& x) {
  return f(caf::meta::type_name("mote_presence"), x.presence, x.cause);
}

template <class F>
auto inspect(F& f, restart_proxy& x) {
  return f(caf::meta::type_name("restart_proxy"), x.mote);
}

template <class F>
auto inspect(F& f, apply_fault& x) {
  return f(caf::meta::type_name("apply_fault"), x.index);
}

template <class F>
auto inspect(F& f, restart_sink& x) {
  return f(caf::meta::type_name("restart_sink"), x.island);
}

template <class F>
auto inspect(F& f, end_fault& x) {
  return f(caf::meta::type_name("end_fault"), x.index);
}

template <class F>
auto inspect(F& f, restart_mote& x) {
  return f(caf::meta::type_name("restart_mote"), x.mote);
}

template <class F>
auto inspect(F& f, collect_report&) {
  return f(caf::meta::type_name("collect_report"));
}

template <class F>
auto inspect(F& f, deliver_report&) {
  return f(caf::meta::type_name("deliver_report"));
}

} // namespace rubicon

CAF_BEGIN_TYPE_ID_BLOCK(rubicon, caf::first_custom_type_id)
CAF_ADD_TYPE_ID(rubicon, (rubicon::timer_expired))
CAF_ADD_TYPE_ID(rubicon, (rubicon::status_request))
CAF_ADD_TYPE_ID(rubicon, (rubicon::story))
CAF_ADD_TYPE_ID(rubicon, (rubicon::actor_failed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::request_unmet))
CAF_ADD_TYPE_ID(rubicon, (rubicon::mote_flat))
CAF_ADD_TYPE_ID(rubicon, (rubicon::listing_changed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::radio_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::energy_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::flow_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::message_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::network_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::serial_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::devices_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::peer_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::proxy_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::program_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::sample_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::take_sample))
CAF_ADD_TYPE_ID(rubicon, (rubicon::apply_fault))
CAF_ADD_TYPE_ID(rubicon, (rubicon::restart_mote))
CAF_ADD_TYPE_ID(rubicon, (rubicon::collect_report))
CAF_ADD_TYPE_ID(rubicon, (rubicon::deliver_report))
CAF_ADD_TYPE_ID(rubicon, (rubicon::frame_received))
CAF_ADD_TYPE_ID(rubicon, (rubicon::radio_done))
CAF_ADD_TYPE_ID(rubicon, (rubicon::battery_flat))
CAF_ADD_TYPE_ID(rubicon, (rubicon::battery_low))
CAF_ADD_TYPE_ID(rubicon, (rubicon::attach_radio))
CAF_ADD_TYPE_ID(rubicon, (rubicon::radio_send))
CAF_ADD_TYPE_ID(rubicon, (rubicon::radio_power))
CAF_ADD_TYPE_ID(rubicon, (rubicon::move_radio))
CAF_ADD_TYPE_ID(rubicon, (rubicon::move_mote))
CAF_ADD_TYPE_ID(rubicon, (rubicon::serial_octets))
CAF_ADD_TYPE_ID(rubicon, (rubicon::attach_serial))
CAF_ADD_TYPE_ID(rubicon, (rubicon::serial_write))
CAF_ADD_TYPE_ID(rubicon, (rubicon::plug_serial))
CAF_ADD_TYPE_ID(rubicon, (rubicon::membership_changed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::message_received))
CAF_ADD_TYPE_ID(rubicon, (rubicon::send_ended))
CAF_ADD_TYPE_ID(rubicon, (rubicon::transducers_read))
CAF_ADD_TYPE_ID(rubicon, (rubicon::actuator_changed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::outputs_wanted))
CAF_ADD_TYPE_ID(rubicon, (rubicon::claim_am_type))
CAF_ADD_TYPE_ID(rubicon, (rubicon::send_message))
CAF_ADD_TYPE_ID(rubicon, (rubicon::read_transducers))
CAF_ADD_TYPE_ID(rubicon, (rubicon::set_actuator))
CAF_ADD_TYPE_ID(rubicon, (rubicon::crash_now))
CAF_ADD_TYPE_ID(rubicon, (rubicon::end_battery))
CAF_ADD_TYPE_ID(rubicon, (rubicon::link_octets))
CAF_ADD_TYPE_ID(rubicon, (rubicon::link_closed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::link_opened))
CAF_ADD_TYPE_ID(rubicon, (rubicon::condition_changed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::attempt_failed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::announcement))
CAF_ADD_TYPE_ID(rubicon, (rubicon::link_sent))
CAF_ADD_TYPE_ID(rubicon, (rubicon::join_lan))
CAF_ADD_TYPE_ID(rubicon, (rubicon::lan_connect))
CAF_ADD_TYPE_ID(rubicon, (rubicon::lan_announce))
CAF_ADD_TYPE_ID(rubicon, (rubicon::lan_link_ended))
CAF_ADD_TYPE_ID(rubicon, (rubicon::set_lan_power))
CAF_ADD_TYPE_ID(rubicon, (rubicon::begin_lan_fault))
CAF_ADD_TYPE_ID(rubicon, (rubicon::end_lan_fault))
CAF_ADD_TYPE_ID(rubicon, (rubicon::pause_peer))
CAF_ADD_TYPE_ID(rubicon, (rubicon::resume_peer))
CAF_ADD_TYPE_ID(rubicon, (rubicon::step_clock))
CAF_ADD_TYPE_ID(rubicon, (rubicon::leave_network))
CAF_ADD_TYPE_ID(rubicon, (rubicon::restart_peer))
CAF_ADD_TYPE_ID(rubicon, (rubicon::end_duplicate))
CAF_ADD_TYPE_ID(rubicon, (rubicon::end_run))
CAF_ADD_TYPE_ID(rubicon, (rubicon::tuple_event))
CAF_ADD_TYPE_ID(rubicon, (rubicon::peis_message))
CAF_ADD_TYPE_ID(rubicon, (rubicon::peis_outcome))
CAF_ADD_TYPE_ID(rubicon, (rubicon::set_tuple))
CAF_ADD_TYPE_ID(rubicon, (rubicon::delete_tuple))
CAF_ADD_TYPE_ID(rubicon, (rubicon::set_remote_tuple))
CAF_ADD_TYPE_ID(rubicon, (rubicon::watch_tuples))
CAF_ADD_TYPE_ID(rubicon, (rubicon::watch_subscribers))
CAF_ADD_TYPE_ID(rubicon, (rubicon::subscribers_changed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::watch_clock))
CAF_ADD_TYPE_ID(rubicon, (rubicon::clock_changed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::broadcast_peis_message))
CAF_ADD_TYPE_ID(rubicon, (rubicon::hook_port))
CAF_ADD_TYPE_ID(rubicon, (rubicon::send_peis_message))
CAF_ADD_TYPE_ID(rubicon, (rubicon::mote_presence))
CAF_ADD_TYPE_ID(rubicon, (rubicon::restart_proxy))
CAF_ADD_TYPE_ID(rubicon, (rubicon::bluetooth_seen))
CAF_ADD_TYPE_ID(rubicon, (rubicon::hello_answer))
CAF_ADD_TYPE_ID(rubicon, (rubicon::hello_arrived))
CAF_ADD_TYPE_ID(rubicon, (rubicon::bluetooth_opened))
CAF_ADD_TYPE_ID(rubicon, (rubicon::join_bluetooth))
CAF_ADD_TYPE_ID(rubicon, (rubicon::scan_bluetooth))
CAF_ADD_TYPE_ID(rubicon, (rubicon::send_hello))
CAF_ADD_TYPE_ID(rubicon, (rubicon::bluetooth_connect))
CAF_ADD_TYPE_ID(rubicon, (rubicon::move_machine))
CAF_ADD_TYPE_ID(rubicon, (rubicon::start_component))
CAF_ADD_TYPE_ID(rubicon, (rubicon::stop_component))
CAF_ADD_TYPE_ID(rubicon, (rubicon::quit_peer))
CAF_ADD_TYPE_ID(rubicon, (rubicon::component_started))
CAF_ADD_TYPE_ID(rubicon, (rubicon::component_ended))
CAF_ADD_TYPE_ID(rubicon, (rubicon::kernel_guarded))
CAF_ADD_TYPE_ID(rubicon, (rubicon::quit_wanted))
CAF_ADD_TYPE_ID(rubicon, (rubicon::process_output))
CAF_ADD_TYPE_ID(rubicon, (rubicon::process_ended))
CAF_ADD_TYPE_ID(rubicon, (rubicon::guard_kernel))
CAF_ADD_TYPE_ID(rubicon, (rubicon::program_attached))
CAF_ADD_TYPE_ID(rubicon, (rubicon::program_detached))
CAF_ADD_TYPE_ID(rubicon, (rubicon::program_events))
CAF_ADD_TYPE_ID(rubicon, (rubicon::attach_program))
CAF_ADD_TYPE_ID(rubicon, (rubicon::program_commands))
CAF_ADD_TYPE_ID(rubicon, (rubicon::mote_started))
CAF_ADD_TYPE_ID(rubicon, (rubicon::restart_program))
CAF_ADD_TYPE_ID(rubicon, (rubicon::declare_meta_tuple))
CAF_ADD_TYPE_ID(rubicon, (rubicon::set_meta_tuple))
CAF_ADD_TYPE_ID(rubicon, (rubicon::watch_indirectly))
CAF_ADD_TYPE_ID(rubicon, (rubicon::gateway_status))
CAF_ADD_TYPE_ID(rubicon, (rubicon::gateway_changed))
CAF_ADD_TYPE_ID(rubicon, (rubicon::store_written))
CAF_ADD_TYPE_ID(rubicon, (rubicon::radio_left))
CAF_ADD_TYPE_ID(rubicon, (rubicon::restart_sink))
CAF_ADD_TYPE_ID(rubicon, (rubicon::end_fault))
CAF_ADD_TYPE_ID(rubicon, (rubicon::make_noise))
CAF_ADD_TYPE_ID(rubicon, (rubicon::lose_frames))
CAF_ADD_TYPE_ID(rubicon, (rubicon::carry_away))
CAF_ADD_TYPE_ID(rubicon, (rubicon::bring_radio))
CAF_END_TYPE_ID_BLOCK(rubicon)
