#include "communication/ports/stream_port.hpp"

#include <algorithm>
#include <utility>

#include "core/codec.hpp"

namespace rubicon::communication {

namespace {

/// Says where a sensor record comes from, if its island was not known when it was taken.
void set_island(bytes& record, island_id island) {
  const auto octets = byte_writer().big(island.value).finish();
  if (record.size() < octets.size() || byte_reader(record).big<std::uint32_t>() != 0)
    return;
  std::ranges::copy(octets, record.begin());
}

} // namespace

int stream_port::open_end(std::size_t program, const stream_end& end) {
  if (!node_.may_send()) {
    node_.refuse();
    return -1;
  }
  stream::remote_request x;
  x.destination = end.other;
  x.name = end.name;
  x.rate = std::chrono::milliseconds(end.rate_ms);
  x.qos = end.qos;
  x.buffer_size = end.buffer_size;
  x.writes_to_self = end.writes_to_self;
  const auto slack = messages_.far_slack(x.destination);
  return accept_open(program, streams_.open_remote(node_.address(), x, node_.now, slack));
}

int stream_port::open_sensor(std::size_t program, std::uint8_t transducer, std::uint32_t period_ms,
                             stream::sampling kind) {
  if (!has_transducer(node_.config.transducer_mask, transducer)) {
    node_.refuse();
    return -1;
  }
  stream::sensor_request x;
  x.transducer = transducer;
  x.kind = kind;
  x.period = std::chrono::milliseconds(period_ms);
  return accept_open(program, streams_.open_sensor(x, node_.now));
}

int stream_port::open_local(std::size_t program) {
  return accept_open(program, streams_.open_local());
}

int stream_port::accept_open(std::size_t program, stream::answer x) {
  if (x.refused) {
    node_.refuse();
    return -1;
  }
  owners_[x.stream] = program;
  apply(std::move(x.todo));
  return x.stream.value;
}

status stream_port::accept(stream::answer x) {
  if (x.refused)
    return node_.refuse();
  apply(std::move(x.todo));
  return SUCCESS;
}

status stream_port::close(stream::descriptor stream) {
  const auto done = accept(streams_.close(stream));
  if (done == SUCCESS)
    owners_.erase(stream);
  return done;
}

status stream_port::read(stream::descriptor stream, std::size_t octets) {
  return accept(streams_.read(stream, octets));
}

status stream_port::write(stream::descriptor stream, byte_view record) {
  return accept(streams_.write(stream, record, node_.now));
}

void stream_port::leave(std::size_t program) {
  for (const auto id : owned(owners_, program))
    close(id);
}

std::optional<duration> stream_port::latency_bound(stream::descriptor stream) const {
  const auto channel = streams_.channel_of(stream);
  return channel ? channels_.latency_bound(*channel) : std::nullopt;
}

void stream_port::on_connected(std::uint16_t descriptor, stream::channel_handle channel) {
  apply(streams_.on_connected(stream::descriptor(descriptor), channel, node_.now));
}

void stream_port::on_connect_failed(std::uint16_t descriptor) {
  apply(streams_.on_connect_failed(stream::descriptor(descriptor)));
}

void stream_port::on_accepted(stream::channel_handle channel, mote_address source,
                              duration far_slack) {
  apply(streams_.on_accepted(channel, source, node_.now, far_slack));
}

void stream_port::on_octets(stream::channel_handle channel, byte_view octets) {
  apply(streams_.on_channel_octets(channel, octets, node_.now));
}

void stream_port::on_closed(stream::channel_handle channel) {
  apply(streams_.on_channel_closed(channel));
}

void stream_port::on_sample(stream::descriptor stream, const stream::sensor_record& x) {
  apply(streams_.on_sample(stream, x));
}

void stream_port::on_time() {
  apply(streams_.on_time(node_.now));
}

void stream_port::apply(stream::outputs todo) {
  for (auto& each : todo) {
    if (const auto* request = std::get_if<stream::connect_channel>(&each)) {
      channels_.connect({false, request->stream.value}, request->destination, request->interval,
                        request->size, request->qos);
    } else if (auto* packet = std::get_if<stream::send_on_channel>(&each)) {
      channels_.send(packet->channel, std::move(packet->octets));
    } else if (const auto* over = std::get_if<stream::disconnect>(&each)) {
      channels_.disconnect(over->channel);
    } else if (const auto* wanted = std::get_if<stream::sample>(&each)) {
      node_.outputs.emplace_back(sample_wanted{wanted->stream, wanted->transducer});
    } else if (const auto* opened = std::get_if<stream::open_done>(&each)) {
      programs_.notify_owner(owners_, opened->stream, [x = *opened](auto& events) {
        events.openRemoteDone(x.stream.value, x.name, status_of(x.success));
      });
      if (!opened->success)
        owners_.erase(opened->stream);
    } else {
      on_read(std::get<stream::read_done>(each));
    }
  }
}

/// Records that were taken before the island was known leave with it (STR-07).
void stream_port::on_read(stream::read_done& x) {
  if (node_.island && streams_.is_sensor(x.stream))
    set_island(x.content, *node_.island);
  programs_.notify_owner(owners_, x.stream, [done = std::move(x)](auto& events) {
    events.readDone(done.stream.value, done.content, status_of(done.success));
  });
}

} // namespace rubicon::communication
