// remote_process: streams.
#include <algorithm>
#include <utility>

#include "communication/layer.hpp"
#include "communication/remote_process.hpp"

namespace rubicon::communication {

bool remote_process::has_stream(kind what, std::uint16_t name) const {
  return std::ranges::any_of(
      streams_, [&](const auto& x) { return x.second.what == what && x.second.name == name; });
}

int remote_process::open_end(const stream_end& end) {
  const auto to = self_ ? resolved(end.other, own_island) : end.other;
  const auto what = to == self_ && !end.writes_to_self ? kind::reader : kind::writer;
  if (!may_talk() || to.mote == broadcast_mote || end.buffer_size == 0 ||
      end.buffer_size > node_.record_max || has_stream(what, end.name) ||
      streams_.size() >= node_.streams_max || !has_room()) {
    refuse();
    return -1;
  }
  const auto id =
      add(streams_, last_stream_,
          {.what = what, .is_opening = true, .record_max = end.buffer_size, .name = end.name});
  commands_.emplace_back(remote::open_end{id, end});
  return id;
}

int remote_process::open_sensor(std::uint8_t transducer, std::uint32_t period_ms,
                                stream::sampling kind_of_it) {
  const bool is_periodic = kind_of_it == stream::sampling::periodic;
  if (!has_transducer(node_.transducer_mask, transducer) || (is_periodic && period_ms == 0) ||
      streams_.size() >= node_.streams_max || !has_room()) {
    refuse();
    return -1;
  }
  remote::open_sensor command{0, transducer, is_periodic, period_ms};
  command.stream = add(streams_, last_stream_, {.what = kind::sensor, .sensor = command});
  commands_.emplace_back(command);
  return command.stream;
}

int remote_process::open_local() {
  if (streams_.size() >= node_.streams_max || !has_room()) {
    refuse();
    return -1;
  }
  const auto id = add(streams_, last_stream_, stream_row{.record_max = node_.record_max});
  commands_.emplace_back(remote::open_local{id});
  return id;
}

status remote_process::close(int desc) {
  const auto* x = find(streams_, desc);
  if (x == nullptr)
    return refuse();
  const auto id = static_cast<std::uint16_t>(desc);
  if (x->is_opening)
    pending_events_.emplace_back(
        [id, name = x->name](auto& y) { y.openRemoteDone(id, name, FAIL); });
  if (x->is_reading)
    pending_events_.emplace_back([id](auto& y) { y.readDone(id, {}, FAIL); });
  streams_.erase(id);
  commands_.emplace_back(remote::close_stream{id});
  return SUCCESS;
}

status remote_process::read(int desc, std::size_t nbytes) {
  auto* x = find(streams_, desc);
  if (x == nullptr || x->what == kind::writer || x->is_opening || x->is_reading || x->has_ended ||
      nbytes == 0 || !has_room())
    return refuse();
  x->is_reading = true;
  commands_.emplace_back(remote::read_stream{static_cast<std::uint16_t>(desc), nbytes});
  return SUCCESS;
}

status remote_process::write(int desc, byte_view record) {
  const auto* x = find(streams_, desc);
  const bool takes = x != nullptr && (x->what == kind::writer || x->what == kind::local);
  if (!takes || x->is_opening || x->has_ended || record.size() > x->record_max || !has_room())
    return refuse();
  commands_.emplace_back(
      remote::write_stream{static_cast<std::uint16_t>(desc), payload(to_bytes(record))});
  return SUCCESS;
}

bool remote_process::has_ended(int desc) const {
  const auto* x = find(streams_, desc);
  return x != nullptr && x->has_ended;
}

std::optional<duration> remote_process::latency_bound(int desc) const {
  const auto* x = find(streams_, desc);
  return x == nullptr ? std::nullopt : x->latency_bound;
}

void remote_process::apply(const remote::stream_opened& x) {
  auto* row = find(streams_, x.stream);
  if (row == nullptr) // closed in the meantime, and reported
    return;
  row->is_opening = false;
  if (x.latency_bound > duration{})
    row->latency_bound = x.latency_bound;
  if (!x.success)
    streams_.erase(x.stream);
  pending_events_.emplace_back(
      [x](auto& y) { y.openRemoteDone(x.stream, x.name, status_of(x.success)); });
}

void remote_process::apply(const remote::record_read& x) {
  auto* row = find(streams_, x.stream);
  if (row == nullptr)
    return;
  row->is_reading = false;
  row->has_ended = row->has_ended || !x.success;
  pending_events_.emplace_back(
      [x](auto& y) { y.readDone(x.stream, x.record.view(), status_of(x.success)); });
}

void remote_process::apply(const remote::stream_ended& x) {
  if (auto* row = find(streams_, x.stream))
    row->has_ended = true;
}

} // namespace rubicon::communication
