// The face of one mote in the tuple space (D1.1 3.2.2, 4.1.1, 4.2.5).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/delay_histogram.hpp"
#include "core/numbers/latency_estimate.hpp"
#include "core/numbers/running_mean.hpp"
#include "core/time.hpp"
#include "core/tuples/device_keys.hpp"
#include "proxy/classes/class_change.hpp"
#include "proxy/classes/input_channel.hpp"
#include "proxy/classes/layout.hpp"
#include "proxy/classes/program.hpp"
#include "proxy/classes/proxy_class.hpp"
#include "proxy/classes/signature.hpp"
#include "proxy/classes/tuple_key.hpp"
#include "proxy/classes/tuple_template.hpp"

namespace rubicon::proxy {

/// Set this tuple in the proxy's own space.
struct publish {
  std::string key;
  std::string text;
};

/// Set `devices.$ID.input.$CH` at the gateway, whose peer id is gateway_of(mote.island).
struct write_device {
  mote_address mote;
  std::uint16_t channel = 0;
  bytes octets;
};

/// Set `devices.$ID.output.$CH.period` there (IF-04).
struct write_period {
  mote_address mote;
  std::uint16_t channel = 0;
  duration period{};
};

/// Make this own tuple a meta tuple that points at an own one, unless it is a meta tuple already.
struct declare {
  std::string key;
  std::string target;
};

/// The mote has been gone for so long that the proxy should end (PXY-20).
struct retire {};

/// A tuple that the proxy subscribes to.
struct watch {
  enum class source : std::uint8_t {
    own,     ///< own tuple that others write: hand its tuple_text() to on_input()
    meta,    ///< what this own meta tuple points at, whoever owns it: the same
    gateway, ///< tuple of gateway_of(island): hand it to on_gateway_tuple()
  };

  source where = source::own;
  std::string key;
  std::string input; ///< first argument of on_input(); empty for a gateway's tuple

  friend bool operator==(const watch&, const watch&) = default;
};

/// In tuples: there is nothing to say, or nothing was received yet.
inline constexpr std::string_view nothing_word = "none";

/// What a proxy did, for the report. Every request has one outcome:
/// requested = acknowledged + sent + sum of failed + open_requests().
struct proxy_counters {
  std::uint64_t requested = 0;
  std::uint64_t acknowledged = 0;
  std::uint64_t sent = 0;  ///< to a mote that acknowledges nothing
  duration slowest{};      ///< of those acknowledged, since they were asked for
  delay_histogram latency; ///< of the same
  std::map<std::string, std::uint64_t>
      failed;                        ///< failed, unreachable, refused, superseded, timeout
  std::uint64_t retries = 0;         ///< writes of requests after their first
  std::uint64_t messages = 0;        ///< from the mote, decoded
  std::uint64_t late = 0;            ///< messages and records older than the latency published
  std::uint64_t other_times = 0;     ///< the same, whose time cannot be one of the network's
  std::uint64_t short_messages = 0;  ///< too short for the class: dropped
  std::uint64_t unread_messages = 0; ///< on a channel without fields: dropped
  std::uint64_t bad_statuses = 0;    ///< input status tuples that are none: dropped
  std::uint64_t foreign_tuples = 0;  ///< keys or inputs that are not this proxy's: dropped
  std::uint64_t bad_keys = 0;        ///< own keys over the limits: not published
  std::uint64_t foreign_names = 0;   ///< what a program says that is not in its names(): dropped
};
RUBICON_FIELDS(proxy_counters, requested, acknowledged, sent, slowest, latency, failed, retries,
               messages, late, other_times, short_messages, unread_messages, bad_statuses,
               foreign_tuples, bad_keys, foreign_names);

/// One mote's face. It speaks tuples alone: raw ones with the mote's gateway, readable ones with
/// the ecology (PXY-04, 05, 06, 12, 14).
///
/// Own tuples, below the class's prefix:
///   status                   `active`, `inactive`, `stale` or `lost` (PXY-16, PXY-20), set last at
///                            the start
///   status.cause             why it is lost, in one word; `none` otherwise
///   status.since             in seconds of ecology time
///   class, id, island        prior and indirect information: the class's name, `island/mote`, and
///                            the name of the island whose gateway perceives the mote
///   PROPERTY                 of the class
///   interface, position, position.accuracy   of a class with `indirect` (PXY-06): whose gateway
///                            perceives the mote, and where the mote is: where the class's table of
///                            objects says (`prior`), else where that interface is (`interface`)
///   FIELD, FIELD.unit        newest reading, set at each reading even if equal (CB-01)
///   FIELD.latency            in seconds: how old a reading is expected to be at most when it
///   comes,
///                            from those before it, if its messages or records hold their time
///                            (IF-05)
///   FIELD.freshness          of a class with `stale_after`: `fresh` or `stale`, once there was a
///                            reading
///   what its program says    beside the fields
///   INPUT                    others write a word here; `none` at the start, so that it exists and
///                            shows everybody who owns it; not set by the proxy afterwards
///   mi-INPUT                 of an input with `meta`: which tuple the input is, at first INPUT;
///                            who rewrites it decides what the actuator follows (META-05)
///   INPUT.deadline           in seconds: a request has its outcome by then
///   INPUT.latency            in seconds: what a request is expected to take at most until it is
///                            acknowledged, from those before it; the deadline at first (IF-07)
///   INPUT.words              the words the input knows, between blanks
///   INPUT.range, INPUT.unit  of one that takes numbers: the least and the greatest
///   templates                of the class, under keys of their own
///   INPUT.outcome            `on acknowledged`: the word, the last blank, the outcome; once per
///                            request; `?` for a refused word that is long or not plain
///
///   active <--sensed-- inactive     active --not sensed for inactive_after--> inactive
///   any --listed--> active          any --stale--> stale (its gateway receives nothing from its
///   sink) any --left--> lost              lost --retire_after--> lost, with retire
class proxy {
public:
  using output = std::variant<publish, declare, write_device, write_period, retire>;
  using outputs = std::vector<output>;
  enum class state : std::uint8_t { active, inactive, stale, lost };

  proxy() = default;
  /// With the settings and the program of its class.
  /// @param slack what outcomes of the mote's gateway take longer, as radios of its island sleep
  proxy(proxy_class what, proxy_identity who, duration slack = {});

  /// Prior information; call it once, when the manager has started the proxy.
  [[nodiscard]] outputs start(instant now);

  /// Its class has changed (ACT-10). Afterwards there may be more of watches(), behind the others.
  [[nodiscard]] outputs on_class_changed(const class_change& x);

  /// The tuples of interest; they change with the class only.
  [[nodiscard]] std::vector<watch> watches() const;

  /// Whether the percept is this proxy's object (PXY-08).
  [[nodiscard]] bool consumes(const signature& percept) const;

  /// A tuple of the gateway has a new value: on_output() or on_input_status(), by its key.
  [[nodiscard]] outputs on_gateway_tuple(std::string_view key, byte_view value, instant now);

  /// The time that peers share is so much ahead of `now`, since 1970: stamps are converted by it if
  /// reads_times() of its class.
  void on_clock(duration ahead) { network_ahead_ = ahead; }

  /// The mote has sent a message on an output channel.
  [[nodiscard]] outputs on_output(std::uint16_t channel, byte_view payload, instant now);

  /// A record of one of streams_of() its class, whose read ends are open at its peer.
  /// @param time_ms the record's own
  [[nodiscard]] outputs on_record(std::uint16_t stream, std::int16_t value, std::uint32_t time_ms,
                                  instant now);

  /// The gateway reports the outcome of a write on an input channel.
  [[nodiscard]] outputs on_input_status(std::uint16_t channel, std::string_view text, instant now);

  /// Somebody wants `text` of the input called `name`. An empty text and the marker `none` ask for
  /// nothing, unless the class has them as words: own writes may come back here. A lost mote is
  /// unreachable at once, with nothing written.
  [[nodiscard]] outputs on_input(std::string_view name, std::string_view text, instant now);

  /// What the manager knows of the mote. @param cause one word, if it has left
  [[nodiscard]] outputs on_presence(device_presence x, std::string_view cause, instant now);

  /// Another gateway leads the mote's island: what is written to it from now on is new to it.
  /// @param name the gateway's, empty if it is not known
  [[nodiscard]] outputs on_gateway_changed(std::string name, instant now);
  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()

  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] state status() const { return state_; }
  [[nodiscard]] const std::string& prefix() const { return prefix_; }
  [[nodiscard]] const proxy_class& what() const { return class_; }
  [[nodiscard]] const proxy_identity& who() const { return who_; }
  [[nodiscard]] const proxy_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t open_requests() const;

  /// The greatest latency of readings that it publishes at present; nothing if there is none.
  [[nodiscard]] std::optional<duration> reading_latency() const;

  /// Newest reading of each field, by name: `22.3 C`.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> values() const;

private:
  [[nodiscard]] std::string key_of(std::string_view suffix) const;
  void say(std::string key, std::string text, outputs& out);
  void say_prior_information(outputs& out);
  void declare_meta(const std::string& input, outputs& out);
  void say_indirect_information(outputs& out);
  void say_state(instant now, outputs& out);
  void say_readings(std::vector<reading> all, outputs& out);
  void say_of_program(std::vector<reading> all, outputs& out);
  void update_program_time(instant now, outputs& out);
  void ask_for_period(outputs& out) const;
  [[nodiscard]] std::int64_t whole_stamp(std::int64_t count, instant now) const;
  void say_counts(reading_source from, const field_counts& counts, instant now, outputs& out);
  void judge_age(reading_source from, std::uint32_t stamp, instant now, outputs& out);
  void refresh(reading_source from, instant now, outputs& out);
  void mark_stale(instant now, outputs& out);
  void say_freshness(reading_source from, std::string_view word, outputs& out);
  [[nodiscard]] std::set<std::uint16_t> output_channels() const;
  void enter(state next, instant now, outputs& out);
  void sensed(instant now, outputs& out);
  void apply(std::uint16_t channel, input_channel::outputs todo, outputs& out);
  [[nodiscard]] duration answer_timeout() const;
  [[nodiscard]] duration deadline_of(std::uint16_t channel) const;
  void note_latency(std::uint16_t channel, duration taken, outputs& out);
  void publish_outcome(std::size_t input, std::string_view word, request_outcome outcome,
                       outputs& out);
  [[nodiscard]] std::optional<instant> presence_deadline() const;

  proxy_class class_;
  proxy_identity who_;
  duration slack_{};
  std::string prefix_;
  tuple_templates templates_;
  std::unique_ptr<program> program_;           ///< nullptr: none
  std::map<std::string, bool> program_names_;  ///< and whether its unit was published
  std::map<std::string, running_mean> means_;  ///< of fields that are computed here
  std::map<reading_source, instant> stale_at_; ///< of those whose values are fresh
  state state_ = state::active;
  std::optional<instant> last_sensed_; ///< nothing before start()
  std::optional<duration> network_ahead_;
  std::string cause_{nothing_word}; ///< of being lost
  instant lost_since_{};
  bool retired_ = false;
  std::map<std::uint16_t, input_channel> channels_;
  struct published_latency {
    latency_estimate estimate;
    std::optional<duration> published{};
  };
  std::map<std::uint16_t, published_latency> latencies_; ///< of channels that have acknowledged
  std::map<reading_source, published_latency> ages_;     ///< of what has come with its time
  std::map<std::string, reading> newest_;
  proxy_counters counters_;
};

[[nodiscard]] std::string_view to_string(proxy::state x);

} // namespace rubicon::proxy
