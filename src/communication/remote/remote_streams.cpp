#include "communication/remote/remote_streams.hpp"

#include <algorithm>
#include <utility>

#include "communication/ports/local_node.hpp"

namespace rubicon::communication {

bool remote_streams::has_stream(kind what, std::uint16_t name) const {
  return std::ranges::any_of(streams_.all(), [&](const auto& x) {
    return x.second.what == what && x.second.name == name;
  });
}

int remote_streams::open_end(const stream_end& end) {
  const auto to = resolved(exchange_, end.other, own_island);
  const auto what = to == exchange_.address() && !end.writes_to_self ? kind::reader : kind::writer;
  if (!exchange_.may_send() || to.mote == broadcast_mote || end.buffer_size == 0 ||
      end.buffer_size > exchange_.node().record_max || has_stream(what, end.name) ||
      streams_.all().size() >= exchange_.node().streams_max || !exchange_.has_room()) {
    exchange_.refuse();
    return -1;
  }
  const auto id = streams_.add(
      {.what = what, .is_opening = true, .record_max = end.buffer_size, .name = end.name});
  exchange_.command(remote::open_end{id, end});
  return id;
}

int remote_streams::open_sensor(std::uint8_t transducer, std::uint32_t period_ms,
                                stream::sampling kind_of_it) {
  const bool is_periodic = kind_of_it == stream::sampling::periodic;
  if (!has_transducer(exchange_.node().transducer_mask, transducer) ||
      (is_periodic && period_ms == 0) || streams_.all().size() >= exchange_.node().streams_max ||
      !exchange_.has_room()) {
    exchange_.refuse();
    return -1;
  }
  remote::open_sensor command{0, transducer, is_periodic, period_ms};
  command.stream = streams_.add({.what = kind::sensor, .sensor = command});
  exchange_.command(command);
  return command.stream;
}

int remote_streams::open_local() {
  if (streams_.all().size() >= exchange_.node().streams_max || !exchange_.has_room()) {
    exchange_.refuse();
    return -1;
  }
  const auto id = streams_.add({.record_max = exchange_.node().record_max});
  exchange_.command(remote::open_local{id});
  return id;
}

status remote_streams::close(int desc) {
  const auto* x = streams_.find(desc);
  if (x == nullptr)
    return exchange_.refuse();
  const auto id = static_cast<std::uint16_t>(desc);
  if (x->is_opening)
    exchange_.notify([id, name = x->name](auto& y) { y.openRemoteDone(id, name, FAIL); });
  if (x->is_reading)
    exchange_.notify([id](auto& y) { y.readDone(id, {}, FAIL); });
  streams_.erase(id);
  exchange_.command(remote::close_stream{id});
  return SUCCESS;
}

status remote_streams::read(int desc, std::size_t nbytes) {
  auto* x = streams_.find(desc);
  if (x == nullptr || x->what == kind::writer || x->is_opening || x->is_reading || x->has_ended ||
      nbytes == 0 || !exchange_.has_room())
    return exchange_.refuse();
  x->is_reading = true;
  exchange_.command(remote::read_stream{static_cast<std::uint16_t>(desc), nbytes});
  return SUCCESS;
}

status remote_streams::write(int desc, byte_view record) {
  const auto* x = streams_.find(desc);
  const bool takes = x != nullptr && (x->what == kind::writer || x->what == kind::local);
  if (!takes || x->is_opening || x->has_ended || record.size() > x->record_max ||
      !exchange_.has_room())
    return exchange_.refuse();
  exchange_.command(
      remote::write_stream{static_cast<std::uint16_t>(desc), payload(to_bytes(record))});
  return SUCCESS;
}

bool remote_streams::has_ended(int desc) const {
  const auto* x = streams_.find(desc);
  return x != nullptr && x->has_ended;
}

std::optional<duration> remote_streams::latency_bound(int desc) const {
  const auto* x = streams_.find(desc);
  return x == nullptr ? std::nullopt : x->latency_bound;
}

void remote_streams::apply(const remote::stream_opened& x) {
  auto* found = streams_.find(x.stream);
  if (found == nullptr) // closed in the meantime, and reported
    return;
  found->is_opening = false;
  if (x.latency_bound > duration{})
    found->latency_bound = x.latency_bound;
  if (!x.success)
    streams_.erase(x.stream);
  exchange_.notify([x](auto& y) { y.openRemoteDone(x.stream, x.name, status_of(x.success)); });
}

void remote_streams::apply(const remote::record_read& x) {
  auto* found = streams_.find(x.stream);
  if (found == nullptr)
    return;
  found->is_reading = false;
  found->has_ended = found->has_ended || !x.success;
  exchange_.notify([x](auto& y) { y.readDone(x.stream, x.record.view(), status_of(x.success)); });
}

void remote_streams::apply(const remote::stream_ended& x) {
  if (auto* found = streams_.find(x.stream))
    found->has_ended = true;
}

} // namespace rubicon::communication
