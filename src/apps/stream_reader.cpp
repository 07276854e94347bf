#include "apps/stream_reader.hpp"

#include "stream/sensor_record.hpp"

namespace rubicon::apps {

namespace {

constexpr duration pause = 5s; ///< before a stream is opened again

} // namespace

void stream_reader::joined(mote::island_octet, std::uint16_t, mote::status success) {
  if (stream_ > 0)
    layer().close(stream_);
  stream_ = -1;
  retry_.reset();
  if (success == mote::SUCCESS)
    open();
}

void stream_reader::open() {
  retry_.reset();
  const auto accepted = layer().open_remote(
      static_cast<mote::island_octet>(own_island.value), own_mote.value, config_.stream,
      static_cast<std::uint32_t>(config_.every / 1ms), 0, stream::sensor_record::size);
  if (accepted == mote::FAIL)
    retry_ = layer().now() + pause;
}

void stream_reader::openRemoteDone(int stream, std::uint16_t, mote::status success) {
  if (success == mote::FAIL) {
    retry_ = layer().now() + pause;
    return;
  }
  if (openings_++ == 0)
    tell("stream " + std::to_string(config_.stream) + " is open");
  stream_ = stream;
  last_ms_.reset();
  layer().read(stream_, stream::sensor_record::size);
}

void stream_reader::readDone(int stream, byte_view record, mote::status success) {
  if (stream != stream_)
    return;
  if (success == mote::FAIL) { // the writer is gone
    layer().close(stream_);
    stream_ = -1;
    retry_ = layer().now() + pause;
    return;
  }
  if (const auto x = stream::decode_sensor_record(record)) {
    const auto period = static_cast<std::uint32_t>(config_.every / 1ms);
    if (last_ms_ && period > 0) { // rounded: clocks are corrected between records
      const auto steps = (x->time_ms - *last_ms_ + period / 2) / period;
      missing_ += steps > 0 ? steps - 1 : 0;
    }
    last_ms_ = x->time_ms;
    ++records_;
  }
  layer().read(stream_, stream::sensor_record::size);
}

void stream_reader::on_time(instant now) {
  if (retry_ && *retry_ <= now)
    open();
}

std::vector<figure> stream_reader::figures() const {
  const auto all = static_cast<double>(records_ + missing_);
  return {{"records", static_cast<double>(records_)},
          {"records missing", static_cast<double>(missing_)},
          {"delivery %", all > 0 ? 100 * static_cast<double>(records_) / all : 0},
          {"openings", static_cast<double>(openings_)}};
}

} // namespace rubicon::apps
