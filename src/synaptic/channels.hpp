// All synaptic channels of one node, over which the Learning Layer communicates
// (D1.1 4.2.2, 5.3.1).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "synaptic/arrivals.hpp"
#include "synaptic/events.hpp"
#include "synaptic/message.hpp"
#include "synaptic/parameters.hpp"

namespace rubicon::synaptic {

/// What fits a mote; a PC has room for more.
struct channels_config {
  std::size_t channels_max = 2;                     ///< in each direction
  std::size_t early_max = 2;                        ///< accepted channels not created here yet
  std::uint8_t size_max = 10;                       ///< elements of a vector
  static constexpr std::size_t packet_max = 108;    ///< octets, >= 10
  std::chrono::milliseconds tick_period{500};       ///< what connect_channel asks for (CLK-03)
  unsigned silence_max = 20;                        ///< vectors due in a row; > 0 (SYN-17)
  std::uint8_t stop_repeats = 20;                   ///< ticks, until SYN_STOP is acknowledged
  static constexpr duration open_repeat = 2s;       ///< from one SYN_OPEN to the next
  static constexpr duration writer_patience = 30s;  ///< from create_out() to SYN_OPEN_ACK
  static constexpr duration reader_patience = 2min; ///< from create_in() to SYN_OPEN
};

struct channels_counters {
  std::uint64_t created = 0; ///< ends at this node
  std::uint64_t create_failed = 0;
  std::uint64_t failed = 0;   ///< ends whose other end is gone
  std::uint64_t sent = 0;     ///< vectors
  std::uint64_t updated = 0;  ///< vectors
  std::uint64_t missed = 0;   ///< vectors
  std::uint64_t repeated = 0; ///< arrived packets of vectors; the next two too
  std::uint64_t late = 0;
  std::uint64_t untimely = 0;
  std::uint64_t bad_reads = 0; ///< read_input() without a value
  std::uint64_t leaps = 0;     ///< ticks that did not follow the one before
  std::uint64_t refused = 0;   ///< accepted channels given back: no room, or another is there
  std::uint64_t expired = 0;   ///< accepted channels that no program here has created
  std::uint64_t malformed = 0;
  std::uint64_t strays = 0; ///< well-formed, but nothing that its channel waits for
};
RUBICON_FIELDS(channels_counters, created, create_failed, failed, sent, updated, missed, repeated,
               late, untimely, bad_reads, leaps, refused, expired, malformed, strays);

/// The synaptic channels of a mote or PC. At each tick of the RUBICON clock the out end of a
/// started channel sends its vector ChOut; at the next tick the in end reports for each index
/// whether it has come, and shows it. A channel is known by the two nodes it joins (SYN-01), and
/// both create it:
///
///   out: connecting --channel--> asking --SYN_OPEN_ACK--> open --channel closed--> ended
///   in:  waiting --SYN_OPEN--> open --channel closed, or silence--> ended
///
/// Sizes or divisors that differ (SYN-15), and time-outs, end in create_done(failure), and the
/// entry is free. An ended channel keeps its entry until it is disposed of; its other end may be
/// created anew at once. start() and stop() are the out end's; the in end reports from the first
/// vector that arrives until its out end stops.
///
/// A node's channel to itself needs no channel service (SYN-14): what is sent in a tick is shown
/// and reported in that tick, and nothing is ever missed.
///
/// The owner hands over those accepted channels whose first packet is_synaptic().
class channels {
public:
  channels() = default;
  explicit channels(channels_config config) : config_(config) {}

  /// Answers to what we send take so much longer from now on, as radios of our island sleep.
  void set_answer_slack(duration x) { answer_slack_ = x; }

  /// create_done follows. Failures: bad_argument (broadcast, size), already_open, no_room.
  /// @param self this node's address; no_mote in the mote part for a PC
  /// @param destination own_island: the island that `x` says
  /// @param far_slack what answers take longer, as radios of the other end's island sleep
  [[nodiscard]] answer create_out(mote_address self, mote_address destination, std::size_t size,
                                  const parameters& x, instant now, duration far_slack = {});
  [[nodiscard]] answer create_in(mote_address self, mote_address source, std::size_t size,
                                 const parameters& x, instant now, duration far_slack = {});

  /// Stops it, closes it. Failure: bad_descriptor.
  [[nodiscard]] answer dispose(descriptor channel);

  /// Vectors are sent from the next tick on. Once more does nothing. Failures: bad_descriptor,
  /// illegal_operation, not_open_yet, ended.
  [[nodiscard]] answer start(descriptor channel);

  /// Failures: as start(), not_active.
  [[nodiscard]] answer stop(descriptor channel);

  /// Sets element `k` of ChOut. Failures: as start(), bad_argument.
  [[nodiscard]] std::optional<failure> write_output(descriptor channel, std::size_t k, float value);

  /// Element `index` of ChIn, 0 before the first vector. Nothing, and counted, for what is not an
  /// element of an open in end.
  [[nodiscard]] std::optional<float> read_input(descriptor channel, std::size_t index);

  [[nodiscard]] outputs on_connected(descriptor channel, channel_handle handle, instant now);
  [[nodiscard]] outputs on_connect_failed(descriptor channel);

  /// Somebody has opened a channel to this node.
  [[nodiscard]] outputs on_accepted(channel_handle handle, mote_address source, instant now,
                                    duration far_slack = {});
  [[nodiscard]] outputs on_channel_octets(channel_handle handle, byte_view octets);
  [[nodiscard]] outputs on_channel_closed(channel_handle handle);

  /// How long after the tick vectors are sent (SYN-16); from the next tick on.
  void set_slot(duration offset) { slot_ = offset; }

  /// The RUBICON clock ticks. A T that does not follow the last one is a leap (CLK-05): nothing is
  /// reported missed at it. Vectors leave in on_time().
  [[nodiscard]] outputs on_tick(std::uint32_t tick, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// An out end whose vectors leave at some ticks, or will as soon as it is open.
  struct out_end {
    std::optional<channel_handle> channel{}; ///< nothing: it is still to come
    std::size_t size = 0;                    ///< elements
  };
  /// Those of channels to other nodes, in order of creation.
  [[nodiscard]] std::vector<out_end> out_ends() const;

  [[nodiscard]] std::size_t open_channels() const { return rows_.size(); } ///< entries in use
  [[nodiscard]] std::size_t early_channels() const { return early_.size(); }
  [[nodiscard]] const channels_config& config() const { return config_; }
  [[nodiscard]] const channels_counters& counters() const { return counters_; }

  /// Octets on a mote, all channels of the largest size.
  [[nodiscard]] std::size_t footprint() const;

private:
  enum class phase : std::uint8_t { connecting, asking, waiting, open, ended };

  struct row {
    descriptor id{};
    bool is_out = false;
    bool loops = false; ///< both ends are here: there is no channel
    phase at = phase::waiting;
    mote_address other{};
    open_message shape{};
    std::optional<channel_handle> channel{};
    std::optional<instant> due{};
    instant gives_up{};   ///< asking, and connecting
    duration far_slack{}; ///< of the other end's island

    std::vector<float> values{}; ///< ChOut
    bool is_active = false;
    bool sends = false;                       ///< at this tick
    std::optional<std::uint32_t> last_tick{}; ///< of a vector sent
    std::uint8_t stops_left = 0;              ///< SYN_STOPs

    arrivals input{};
  };

  /// A channel that was accepted and is not in use yet.
  struct early {
    channel_handle channel;
    mote_address source;
    std::optional<open_message> request; ///< nothing before SYN_OPEN
    instant due;
  };

  [[nodiscard]] static bool is_opening(const row& x) {
    return x.at != phase::open && x.at != phase::ended;
  }

  [[nodiscard]] row* find(descriptor channel);
  [[nodiscard]] row* find(channel_handle handle);
  [[nodiscard]] row* find(bool is_out, mote_address other); ///< not an ended one
  [[nodiscard]] std::optional<failure> refusal(const row* x, bool wants_out) const;

  [[nodiscard]] answer create(mote_address self, mote_address other, row added, std::size_t size,
                              const parameters& x);
  void join_own(row& x, outputs& todo);
  void join_early(row& x, outputs& todo);
  void opened(row& x, outputs& todo);
  void end(row& x, outputs& todo);
  void drop(descriptor id, outputs& todo);
  void ask(row& x, outputs& todo, instant now);

  void on_open(const early& x, outputs& todo);
  void on_out_message(row& x, const message& content, outputs& todo);
  void on_in_message(row& x, const message& content, outputs& todo);
  void on_vector(row& x, const vector_message& content);

  void report(row& x, std::uint32_t tick, outputs& todo);
  void notify(const row& x, input_status status, outputs& todo);
  void send_all(outputs& todo);
  void send_vector(row& x, outputs& todo);
  void send_stop(row& x, outputs& todo, bool in_slot = false);

  [[nodiscard]] duration patience(duration far_slack) const {
    return config_.writer_patience + 2 * (answer_slack_ + far_slack);
  }

  channels_config config_;
  duration answer_slack_{};
  std::vector<row> rows_; ///< in order of creation
  std::vector<early> early_;
  descriptor last_;
  std::optional<std::uint32_t> tick_; ///< T
  duration slot_{};
  std::optional<instant> sends_at_;
  channels_counters counters_;
};

} // namespace rubicon::synaptic
