#include "apps/average.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::apps {

namespace {

constexpr duration join_pause = 10s; ///< before a stream that could not be opened is tried again

/// Rounded to the nearest, halves up.
std::int16_t mean(std::int64_t sum, std::int64_t count) {
  const auto twice = 2 * sum + count;
  const auto down = twice / (2 * count) - (twice % (2 * count) < 0 ? 1 : 0);
  return static_cast<std::int16_t>(down);
}

} // namespace

average::average(average_config config)
    : stream_application(config.streams, config.every), config_(std::move(config)),
      newest_(config_.streams.size()) {
  for (const auto& x : config_.outputs)
    outputs_.push_back({x});
}

void average::joined(communication::island_octet island, std::uint16_t mote,
                     communication::status success) {
  due_.reset();
  for (auto& x : outputs_)
    close(x);
  stream_application::joined(island, mote, success);
  for (auto& x : outputs_) {
    if (success == communication::SUCCESS)
      open(x);
  }
}

void average::open(write_end& x) {
  x.retry.reset();
  const auto accepted = layer().open_write_end(x.what.to, x.what.stream,
                                               static_cast<std::uint32_t>(config_.every / 1ms), 0,
                                               stream::sensor_record::size);
  if (accepted == communication::FAIL)
    x.retry = layer().now() + join_pause;
}

void average::close(write_end& x) {
  if (x.stream > 0) {
    x.changed = layer().now();
    layer().close(x.stream);
  }
  x.stream = -1;
  x.retry.reset();
}

void average::openRemoteDone(int stream, std::uint16_t name, communication::status success) {
  const auto x =
      std::ranges::find(outputs_, name, [](const write_end& each) { return each.what.stream; });
  if (x == outputs_.end()) {
    stream_application::openRemoteDone(stream, name, success);
  } else if (success == communication::FAIL) {
    ++x->opens_failed;
    if (layer().address()) // else joined() opens it
      x->retry = layer().now() + join_pause;
  } else {
    ++x->openings;
    x->changed = layer().now();
    x->stream = stream;
    if (!due_)
      due_ = layer().now() + config_.every;
  }
}

void average::on_record(std::size_t input, const stream::sensor_record& x) {
  ++read_;
  newest_[input] = x;
}

void average::write() {
  std::int64_t sum = 0;
  std::int64_t count = 0;
  std::optional<std::uint32_t> time_ms;
  for (const auto& x : newest_) {
    if (!x)
      continue;
    sum += x->value;
    ++count;
    if (!time_ms || static_cast<std::int32_t>(x->time_ms - *time_ms) > 0) // it runs over
      time_ms = x->time_ms;
  }
  const auto self = layer().address();
  if (count == 0 || !self) {
    ++without_value_;
    return;
  }
  const auto record = encode(stream::sensor_record{*self, *time_ms, mean(sum, count)});
  for (auto& x : outputs_) {
    if (x.stream < 0)
      continue;
    x.last_ms = *time_ms;
    if (layer().write(x.stream, record) > 0) {
      ++written_;
      ++x.written;
      continue;
    }
    ++x.unwritten;
    close(x);
    x.retry = layer().now() + join_pause;
  }
}

void average::on_time(instant now) {
  stream_application::on_time(now);
  for (auto& x : outputs_) {
    if (x.retry && *x.retry <= now)
      open(x);
  }
  if (!due_ || *due_ > now)
    return;
  while (*due_ <= now)
    *due_ += config_.every;
  write();
}

std::optional<instant> average::deadline() const {
  auto next = earliest(stream_application::deadline(), due_);
  for (const auto& x : outputs_)
    next = earliest(next, x.retry);
  return next;
}

std::vector<figure> average::figures() const {
  return {{"records read", static_cast<double>(read_)},
          {"records written", static_cast<double>(written_)},
          {"times without a value", static_cast<double>(without_value_)}};
}

std::vector<stream_end> average::stream_ends(instant now) const {
  auto all = stream_application::stream_ends(now);
  for (const auto& x : outputs_) {
    stream_end end;
    end.stream = x.what.stream;
    end.writes = true;
    end.reader = x.what.to;
    end.records = x.written + x.unwritten;
    end.unwritten = x.unwritten;
    end.openings = x.openings;
    end.opens_failed = x.opens_failed;
    end.open = x.stream > 0;
    end.changed_at = x.changed;
    end.last_ms = x.last_ms;
    end.every = config_.every;
    all.push_back(end);
  }
  return all;
}

} // namespace rubicon::apps
