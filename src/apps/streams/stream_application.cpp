#include "apps/streams/stream_application.hpp"

#include <algorithm>

namespace rubicon::apps {

namespace {

constexpr duration reopen_pause = 5s; ///< before a stream is opened again

} // namespace

stream_application::stream_application(const std::vector<read_stream>& streams) {
  for (const auto& x : streams)
    inputs_.push_back({.name = x.name, .every = x.every});
}

stream_application::stream_application(const std::vector<std::uint16_t>& streams, duration every) {
  for (const auto name : streams)
    inputs_.push_back({.name = name, .every = every});
}

void stream_application::joined(communication::island_octet, std::uint16_t,
                                communication::status success) {
  retry_.reset();
  for (auto& x : inputs_) {
    if (x.stream > 0) {
      x.changed = layer().now();
      layer().close(x.stream);
      on_lost(static_cast<std::size_t>(&x - inputs_.data()));
    }
    x.stream = -1;
    x.is_wanted = false;
  }
  for (auto& x : inputs_) {
    if (success == communication::SUCCESS)
      open(x);
  }
}

void stream_application::open(read_end& x) {
  x.is_wanted = false;
  const auto accepted = layer().open_remote(
      static_cast<communication::island_octet>(own_island.value), own_mote.value, x.name,
      static_cast<std::uint32_t>(x.every / 1ms), 0, stream::sensor_record::size);
  if (accepted == communication::FAIL) {
    ++opens_failed_;
    retry(x);
  }
}

void stream_application::retry(read_end& x) {
  x.is_wanted = true;
  retry_ = earliest(retry_, layer().now() + reopen_pause);
}

void stream_application::openRemoteDone(int stream, std::uint16_t name,
                                        communication::status success) {
  const auto x = std::ranges::find(inputs_, name, &read_end::name);
  if (x == inputs_.end())
    return;
  if (success == communication::FAIL) {
    ++opens_failed_;
    retry(*x);
    return;
  }
  ++openings_;
  ++x->openings;
  x->changed = layer().now();
  x->stream = stream;
  on_opened(static_cast<std::size_t>(x - inputs_.begin()));
  layer().read(stream, stream::sensor_record::size);
}

void stream_application::readDone(int stream, byte_view record, communication::status success) {
  const auto x = std::ranges::find(inputs_, stream, &read_end::stream);
  if (x == inputs_.end())
    return;
  const auto number = static_cast<std::size_t>(x - inputs_.begin());
  if (success == communication::FAIL) { // the writer is gone
    layer().close(stream);
    x->stream = -1;
    x->changed = layer().now();
    retry(*x);
    on_lost(number);
    return;
  }
  if (const auto read = stream::decode_sensor_record(record)) {
    const auto at = layer().now();
    if (x->records > 0)
      x->pause = std::max(x->pause, at - x->last);
    else
      x->first = at;
    ++x->records;
    x->last = at;
    x->last_ms = read->time_ms;
    on_record(number, *read);
  }
  layer().read(stream, stream::sensor_record::size);
}

std::vector<stream_end> stream_application::stream_ends(instant now) const {
  std::vector<stream_end> all;
  for (const auto& x : inputs_) {
    stream_end end;
    end.stream = x.name;
    end.records = x.records;
    end.openings = x.openings;
    end.open = x.stream > 0;
    end.changed_at = x.changed;
    end.pause = x.records > 0 ? std::max(x.pause, now - x.last) : 0s;
    end.first_at = x.first;
    if (x.records > 0)
      end.last_at = x.last;
    end.last_ms = x.last_ms;
    end.every = x.every;
    all.push_back(end);
  }
  return all;
}

void stream_application::on_time(instant now) {
  if (!retry_ || *retry_ > now)
    return;
  retry_.reset();
  for (auto& x : inputs_) {
    if (x.is_wanted)
      open(x);
  }
}

} // namespace rubicon::apps
