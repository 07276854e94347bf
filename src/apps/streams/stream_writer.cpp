#include "apps/streams/stream_writer.hpp"

#include "stream/sensor_record.hpp"

namespace rubicon::apps {

namespace {

constexpr duration open_pause = 8s; ///< before a stream that could not be opened is tried again:
                                    ///< from half as long to twice as long

} // namespace

void stream_writer::joined(communication::island_octet, std::uint16_t,
                           communication::status success) {
  stop();
  is_member_ = success == communication::SUCCESS;
  if (is_member_)
    open();
}

void stream_writer::open() {
  retry_.reset();
  const auto period = static_cast<std::uint32_t>(config_.every / 1ms);
  const auto accepted = layer().open_remote(
      static_cast<communication::island_octet>(config_.to.island.value), config_.to.mote.value,
      config_.stream, period, 0, stream::sensor_record::size);
  if (accepted == communication::FAIL)
    give_up();
}

/// One end without the other is of no use: whatever is open is closed, and tried again later.
void stream_writer::give_up() {
  ++opens_failed_;
  stop();
  if (is_member_)
    retry_ = layer().now() + rng_.between(open_pause / 2, 2 * open_pause);
}

/// Whatever is open is closed.
void stream_writer::stop() {
  retry_.reset();
  if (sensor_ > 0)
    layer().close(sensor_);
  if (remote_ > 0) {
    changed_ = layer().now();
    layer().close(remote_);
  }
  sensor_ = remote_ = -1;
}

void stream_writer::openRemoteDone(int stream, std::uint16_t, communication::status success) {
  if (success == communication::FAIL) {
    give_up();
    return;
  }
  ++openings_;
  changed_ = layer().now();
  remote_ = stream;
  sensor_ = layer().open_sensor(static_cast<std::uint8_t>(config_.transducer),
                                static_cast<std::uint32_t>(config_.every / 1ms),
                                stream::sampling::periodic);
  if (sensor_ < 0 || layer().read(sensor_, stream::sensor_record::size) == communication::FAIL)
    give_up();
}

void stream_writer::readDone(int stream, byte_view record, communication::status success) {
  if (stream != sensor_)
    return;
  if (success ==
      communication::FAIL) { // in an actor of its own it learns only now what the mote refused
    give_up();
    return;
  }
  if (const auto read = stream::decode_sensor_record(record))
    last_ms_ = read->time_ms;
  if (layer().write(remote_, record) > 0) {
    ++written_;
    layer().read(sensor_, stream::sensor_record::size);
    return;
  }
  ++unwritten_;
  stop();
  retry_ = layer().now() + rng_.between(open_pause / 2, 2 * open_pause);
}

void stream_writer::on_time(instant now) {
  if (retry_ && *retry_ <= now)
    open();
}

std::vector<figure> stream_writer::figures() const {
  return {{"records written", static_cast<double>(written_)},
          {"records not written", static_cast<double>(unwritten_)},
          {"opens failed", static_cast<double>(opens_failed_)}};
}

std::vector<stream_end> stream_writer::stream_ends(instant) const {
  stream_end end;
  end.stream = config_.stream;
  end.writes = true;
  end.reader = config_.to;
  end.records = written_ + unwritten_;
  end.unwritten = unwritten_;
  end.openings = openings_;
  end.opens_failed = opens_failed_;
  end.open = remote_ > 0;
  end.changed_at = changed_;
  end.last_ms = last_ms_;
  end.every = config_.every;
  return {end};
}

} // namespace rubicon::apps
