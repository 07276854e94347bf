#include "config/island/size_check.hpp"

#include <string>
#include <utility>
#include <variant>

#include "config/toml/units.hpp"
#include "radio/mac_rules.hpp"

namespace rubicon::config {

namespace {

/// What a frame takes of the radio's time at least: back-off (half of seven periods of 320 us), the
/// look at the channel and turning round (320 us), 26 octets of headers at 32 us, and 544 us until
/// its acknowledgement is through (IEEE 802.15.4-2006 6.5, 7.5.1.4).
constexpr duration frame_time = 1120us + 320us + 26 * radio::timing::octet + 544us;

/// Serial frames have 16 octets beside the packet, and each is answered with nine.
constexpr std::size_t serial_headers = 16;
constexpr std::size_t serial_ack = 9;

duration radio_time(const apps::load& x) {
  return static_cast<duration::rep>(x.packets) * frame_time +
         static_cast<duration::rep>(x.octets) * radio::timing::octet;
}

std::string rounded(duration x) {
  return std::to_string((x + 1ms - 1ns) / 1ms) + " ms";
}

std::string vectors_text(const apps::load& x) {
  return std::to_string(x.packets) + " packets of " + std::to_string(x.octets) + " octets";
}

} // namespace

std::vector<std::uint16_t> streams_read(const apps::app_config& x) {
  if (const auto* reader = std::get_if<apps::stream_reader_config>(&x))
    return {reader->stream};
  if (const auto* switched = std::get_if<apps::stream_switch_config>(&x))
    return {switched->stream};
  if (const auto* recorder = std::get_if<apps::recorder_config>(&x))
    return recorder->streams;
  if (const auto* average = std::get_if<apps::average_config>(&x))
    return average->streams;
  return {};
}

void end_uniqueness::add(const apps::app_config& x, mark at, complaints& problems) {
  for (const auto name : streams_read(x))
    add_stream(false, name, at, problems);
  if (const auto* writer = std::get_if<apps::stream_writer_config>(&x)) {
    add_stream(true, writer->stream, at, problems);
  } else if (const auto* average = std::get_if<apps::average_config>(&x)) {
    for (const auto& to : average->outputs)
      add_stream(true, to.stream, at, problems);
  } else if (const auto* units = std::get_if<apps::reservoir_config>(&x)) {
    add_synapses(false, units->from, at, problems);
    add_synapses(true, units->to, at, problems);
  } else if (const auto* readout = std::get_if<apps::readout_config>(&x)) {
    add_synapses(false, readout->from, at, problems);
  }
}

void end_uniqueness::add_stream(bool writes, std::uint16_t name, mark at, complaints& problems) {
  streams_.add({writes, name},
               std::string("the ") + (writes ? "write" : "read") + " end of stream " +
                   std::to_string(name) + " at this node",
               at, problems);
}

void end_uniqueness::add_synapses(bool is_out, const std::vector<apps::synapse>& ends, mark at,
                                  complaints& problems) {
  for (const auto& x : ends) {
    if (x.other == mote_address{})
      continue; // there is no such node, which is reported already
    synapses_.add({is_out, x.other},
                  std::string("the channel ") + (is_out ? "to " : "from ") + to_string(x.other) +
                      " of this node",
                  at, problems);
  }
}

std::vector<apps::app_config> programs_of(const std::vector<placed_app>& all) {
  std::vector<apps::app_config> found;
  for (const auto& x : all) {
    if (const auto* program = std::get_if<apps::app_config>(&x.app))
      found.push_back(*program);
    else if (const auto* separate = std::get_if<separate_app>(&x.app))
      found.push_back(separate->program);
  }
  return found;
}

void check_tick(const std::vector<apps::app_config>& programs, island_id island, duration tick,
                mark at, complaints& problems) {
  auto sum = apps::traffic_of(island, programs);
  auto all = sum.vectors;
  all += sum.vectors_in;
  all += sum.up;
  all += sum.down;
  if (radio_time(all) > tick)
    problems.add(at, "the synaptic channels of a mote take " + rounded(radio_time(all)) +
                         " of its radio's time at each tick (" + vectors_text(all) +
                         "), but a tick is " + rounded(tick));
}

void check_tick(const apps::traffic& all, const serial::line_config& line, duration tick, mark at,
                complaints& problems) {
  const auto time = [&](const apps::load& x, std::size_t beside) {
    return serial::transmission_time(x.octets + x.packets * beside, line.baud);
  };
  const auto up = time(all.up, serial_headers);
  // One packet is in flight at a time, until the mote has answered.
  const auto down = time(all.down, serial_headers + serial_ack) +
                    2 * static_cast<duration::rep>(all.down.packets) * line.latency;
  const auto& load = up > down ? all.up : all.down;
  if (std::max(up, down) > tick)
    problems.add(at, "synaptic vectors take " + rounded(std::max(up, down)) +
                         " of the serial line at each tick (" + vectors_text(load) + " at " +
                         std::to_string(line.baud) + " baud), but a tick is " + rounded(tick));
}

} // namespace rubicon::config
