// The Stream System of one node (D1.1 3.3.2, 5.3.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/bounded_queue.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "stream/events.hpp"
#include "stream/message.hpp"
#include "stream/sensor_record.hpp"

namespace rubicon::stream {

struct streams_config {
  std::size_t streams_max = 5;
  std::size_t early_max = 2; ///< accepted channels whose stream is not open here yet
  std::size_t queue_max = 32;
  std::size_t record_max = 105; ///< what a channel packet holds beside SS_WRITE's header
  std::uint8_t transducers = 0; ///< they are numbered from 0 (STR-09)
  /// Records of a reliable stream that its read end has not acked.
  static constexpr std::size_t window_max = 8;
  static constexpr unsigned resends_max = 15; ///< without an ack; then the stream has ended
  /// From one SS_OPEN to the next, and from a record to its repeat.
  static constexpr duration open_repeat = 2s;
  static constexpr duration writer_patience = 30s; ///< from open_remote() to SS_OPEN_ACK (STR-19)
  /// From open_remote() to SS_OPEN, or from SS_OPEN to open_remote().
  static constexpr duration reader_patience = 2min;
  /// Of the last record; those before are then given up as lost.
  static constexpr duration resume_within = 5min;
};

struct streams_counters {
  std::uint64_t opened = 0; ///< remote streams, ends at this node
  std::uint64_t open_failed = 0;
  std::uint64_t stored = 0;        ///< records put into a queue
  std::uint64_t read = 0;          ///< records given to the application
  std::uint64_t dropped = 0;       ///< oldest records of full queues (STR-03)
  std::uint64_t excess_octets = 0; ///< of records longer than what was read
  std::uint64_t oversized = 0;     ///< arrived records longer than the read end's buffer size
  std::uint64_t unclaimed = 0;     ///< arrived records of streams that were not opened here in time
  std::uint64_t lost = 0;          ///< records missing between two that arrived
  std::uint64_t resumed = 0;       ///< records that came with SS_OPEN only
  std::uint64_t repeated = 0;      ///< records that arrived twice or late
  std::uint64_t missed = 0;        ///< times of sampling that on_time() came too late for
  std::uint64_t refused = 0;       ///< accepted channels given back: no room, or the name is taken
  std::uint64_t expired = 0;       ///< accepted channels whose stream was not opened here
  std::uint64_t resent = 0;        ///< records of reliable streams
  std::uint64_t busy = 0;          ///< writes to them refused: nothing but waits for acks
  std::uint64_t throttled = 0;     ///< arrived records of them not taken: the queue is full
  std::uint64_t unconfirmed = 0;   ///< records of them not acked when the stream ended
  std::uint64_t malformed = 0;
  std::uint64_t strays = 0; ///< well-formed, but nothing that its channel or stream waits for
};
RUBICON_FIELDS(streams_counters, opened, open_failed, stored, read, dropped, excess_octets,
               oversized, unclaimed, lost, resumed, repeated, missed, refused, expired, resent,
               busy, throttled, unconfirmed, malformed, strays);

/// Sensor, local and remote streams of one mote or PC. Records wait in bounded queues that drop
/// their oldest (STR-03). Opens and reads are split-phase (STR-02). A remote stream at its two
/// ends:
///
///   writer: connecting --channel--> asking --SS_OPEN_ACK--> open --channel closed--> ended
///   reader: waiting --SS_OPEN--> open --channel closed--> ended
///
/// A stream that was opened with qos_reliable or qos_every_value is one whose records all arrive,
/// in order and once, or it ends: the read end acks them, the write end repeats what is not acked.
/// A full queue drops nothing then, but lets the write end wait, whose writes fail (busy) when
/// window_max records wait.
///
/// Any other stream may lose records, most likely when its channel breaks. The write end keeps the
/// last ones, as many as SS_OPEN holds; when the same ends open the stream again, the read end gets
/// what it lacks of them, for which its queue has room then beside queue_size. In the same way the
/// read end's node keeps what comes before its application opens.
///
/// Before open, time-outs and refusals end in open_done(failure) and the entry is free. An ended
/// stream keeps its entry, and a reader its queue, until its application closes it.
class streams {
public:
  streams() = default;
  explicit streams(streams_config config) : config_(config) {}

  /// Answers to what we send take so much longer from now on, as radios of our island sleep.
  void set_answer_slack(duration x) { answer_slack_ = x; }

  /// Open at once. Equal ones may be open: programs of a node do not know each other, and each has
  /// its own queue and times. Failures: bad_argument (transducer, period, queue size), no_room.
  [[nodiscard]] answer open_sensor(const sensor_request& x, instant now);

  /// Open at once. Records of up to record_max octets. Failures: bad_argument, no_room.
  [[nodiscard]] answer open_local(std::size_t queue_size = queue_size_default);

  /// One end of a remote stream: the read end if `x.destination` is this node (STR-11). open_done
  /// follows. Failures: bad_argument (broadcast, sizes, rate), already_open (this end of a stream
  /// of that name is), no_room.
  /// @param self this node's address; no_mote in the mote part for a PC
  /// @param far_slack what answers take longer, as radios of the other end's island sleep
  [[nodiscard]] answer open_remote(mote_address self, const remote_request& x, instant now,
                                   duration far_slack = {});

  /// Failures: bad_descriptor, illegal_operation, not_open_yet, ended, too_long, busy (a reliable
  /// stream).
  /// @param now matters to reliable streams only
  [[nodiscard]] answer write(descriptor stream, byte_view record, instant now = {});

  /// Takes one record, of which read_done shows the first `nbytes`. Failures:
  /// bad_descriptor, illegal_operation, not_open_yet, busy, bad_argument (nothing to read), ended.
  [[nodiscard]] answer read(descriptor stream, std::size_t nbytes);

  /// Pending opens and reads fail, the channel is closed. Failure: bad_descriptor.
  [[nodiscard]] answer close(descriptor stream);

  /// Answers `sample`. One that was not asked for is ignored.
  [[nodiscard]] outputs on_sample(descriptor stream, const sensor_record& x);

  [[nodiscard]] outputs on_connected(descriptor stream, channel_handle channel, instant now);
  [[nodiscard]] outputs on_connect_failed(descriptor stream);

  /// Somebody has opened a channel to this node.
  [[nodiscard]] outputs on_accepted(channel_handle channel, mote_address source, instant now,
                                    duration far_slack = {});
  [[nodiscard]] outputs on_channel_octets(channel_handle channel, byte_view octets, instant now);
  [[nodiscard]] outputs on_channel_closed(channel_handle channel);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Of an open remote stream whose other end is not here; else nothing.
  [[nodiscard]] std::optional<channel_handle> channel_of(descriptor stream) const;
  [[nodiscard]] bool is_sensor(descriptor stream) const; ///< an open one
  [[nodiscard]] bool has_ended(descriptor stream) const; ///< not closed, nothing to read
  [[nodiscard]] std::size_t open_streams() const { return rows_.size(); } ///< table entries in use
  [[nodiscard]] std::size_t early_channels() const { return early_.size(); }
  [[nodiscard]] const streams_config& config() const { return config_; }
  [[nodiscard]] const streams_counters& counters() const { return counters_; }

  /// Octets on a mote, all streams with queues of the default sizes.
  [[nodiscard]] std::size_t footprint() const;

private:
  enum class kind : std::uint8_t { sensor, local, writer, reader };
  enum class phase : std::uint8_t { connecting, asking, waiting, open, ended };

  struct row {
    descriptor id{};
    kind what = kind::local;
    phase at = phase::open;
    std::size_t record_max = 0;
    bounded_queue<bytes> queue{};
    std::optional<std::size_t> reading{}; ///< octets that the pending read wants
    std::optional<instant> due{};
    sensor_request sensor{};
    bool sampling = false; ///< on_sample() is to come
    std::uint16_t name = 0;
    bool loops = false; ///< both ends are here: there is no channel
    std::optional<channel_handle> channel{};
    mote_address other{};        ///< the other end
    duration far_slack{};        ///< of its island
    std::uint16_t sequence = 0;  ///< of the next record
    std::vector<bytes> recent{}; ///< the last ones that went out, without acks
    instant last_write{};
    instant gives_up{}; ///< asking, and connecting
    bool is_reliable = false;
    std::vector<bytes> unacked{};    ///< records, at the write end of a reliable stream
    std::uint16_t first_unacked = 0; ///< sequence number of the first of them
    unsigned resends = 0;            ///< since an ack
  };

  /// A channel that was accepted and is not a stream's yet.
  struct early {
    channel_handle channel;
    mote_address source;
    std::optional<std::uint16_t> name; ///< nothing before SS_OPEN
    std::uint16_t sequence = 0;
    instant due;
    bool is_reliable = false;
    std::vector<bytes> records{}; ///< the newest, as many as SS_OPEN holds, without acks:
    std::size_t resumed = 0;      ///< so many came with it and are new here, the rest since
    std::uint64_t lost = 0;       ///< records between them that did not come
  };

  /// What an end of a remote stream leaves, for when both open it again.
  struct past {
    kind what;
    std::uint16_t name;
    mote_address other;
    std::uint16_t sequence; ///< of the next record
    std::vector<bytes> recent;
    instant last_write;
  };

  [[nodiscard]] static bool is_opening(const row& x) {
    return x.at != phase::open && x.at != phase::ended;
  }
  [[nodiscard]] bool queue_fits(std::size_t size) const {
    return size > 0 && size <= config_.queue_max;
  }

  [[nodiscard]] row* find(descriptor stream);
  [[nodiscard]] row* find(kind what, std::uint16_t name);
  [[nodiscard]] row* find(channel_handle channel);
  [[nodiscard]] row& add(kind what, std::size_t record_max, std::size_t queue_size);

  void start_writer(row& x, const remote_request& request, mote_address destination, outputs& todo,
                    instant now);
  void start_reader(row& x, outputs& todo, instant now);
  void ask(row& x, outputs& todo, instant now);
  std::size_t keep_recent(std::vector<bytes>& recent, byte_view record) const;
  void remember(row& x);
  [[nodiscard]] const past* recall(kind what, std::uint16_t name, mote_address other) const;
  void resume(early& x, const open_message& request);
  void opened(row& x, outputs& todo);
  void take_channel(row& x, const early& from, outputs& todo);
  void on_early_record(early& x, const write_message& content);
  void give_up(const early& x);
  void end(row& x, outputs& todo);
  void drop(row& x, outputs& todo); ///< `x` and later rows are not where they were afterwards
  [[nodiscard]] bool on_due(row& x, outputs& todo, instant now);

  void store(row& x, bytes record, outputs& todo);
  void serve(row& x, outputs& todo);
  void deliver(row& x, byte_view record, outputs& todo);

  void on_open(early x, const open_message& request, outputs& todo, instant now);
  [[nodiscard]] bool free_name(const early& x, std::uint16_t name, outputs& todo);
  void on_row_message(row& x, const message& content, outputs& todo, instant now);
  void on_record(row& x, const write_message& content, outputs& todo);
  void on_reliable_record(row& x, const write_message& content, outputs& todo);
  void on_ack(row& x, std::uint16_t next, instant now);
  void resend(row& x, outputs& todo, instant now);

  [[nodiscard]] std::size_t recent_max() const;
  [[nodiscard]] duration patience(duration far_slack) const {
    return config_.writer_patience + 2 * (answer_slack_ + far_slack);
  }
  [[nodiscard]] duration repeat_wait(const row& x) const {
    return config_.open_repeat + answer_slack_ + x.far_slack;
  }

  streams_config config_;
  duration answer_slack_{};
  std::vector<row> rows_; ///< in order of opening
  std::vector<early> early_;
  std::vector<past> past_; ///< the oldest first, at most streams_max
  descriptor last_;
  streams_counters counters_;
};

} // namespace rubicon::stream
