// The record of a run: what `rubicon run --record` writes and `rubicon explain` reads, a JSON
// object a line (docs/explain.md). The first line is the header. Fields are written under their
// names, those that are as in an object made by default are left out.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::explain {

inline constexpr int record_version = 4;

/// What happened. Each is a message between actors, or what an actor remarked.
enum class kind : std::uint8_t {
  begun,             ///< something that is followed by itself from here on
  radio_send,        ///< a mote or sink asks its radio for a frame
  radio_done,        ///< how that ended
  frame,             ///< a data frame was on the air
  frame_received,    ///< and reached a mote or sink
  serial_write,      ///< octets given to a serial line
  serial_octets,     ///< octets that came out of it
  plug_serial,       ///< the cable or backbone is plugged in, or not
  backbone_write,    ///< a packet given to a backbone
  backbone_received, ///< and received at its other end
  link_opened,       ///< a PEIS link between two peers
  link_octets,       ///< packages that came over it
  link_lost,         ///< packages that did not
  set_tuple,         ///< a component sets a tuple of its peer
  delete_tuple,      ///< or deletes it
  set_remote_tuple,  ///< or sets one of another peer
  tuple_event,       ///< a component is notified of a tuple
  watch_tuples,      ///< a component subscribes to tuples
  send_peis_message, ///< a component sends a message to another peer
  peis_outcome,      ///< how a request of a component ended
  send_message,      ///< a program gives its mote, gateway or PC a message
  message_received,  ///< a mote gives a program a message
  send_ended,        ///< a program is notified how its send ended
  actuator_changed,  ///< an actuator has been asked to change
  event,             ///< something that a person should know
  ecology,           ///< the description that the live page receives: the text is JSON
  sample,            ///< what was to be seen of the run at that time, likewise
  message_ended,     ///< a message has arrived (yes), or is lost: where (from), why (text)
};

[[nodiscard]] std::string_view to_string(kind x);
[[nodiscard]] std::optional<kind> parse_kind(std::string_view word);

/// One line. Which fields mean something depends on the kind; the others keep their defaults.
struct record {
  std::uint64_t number = 0; ///< ascending; 0: no cause names it
  instant time;
  kind what = kind::event;
  std::string from;          ///< actor path; empty: nobody, or a clock
  std::string to;            ///< actor path; empty for remarks
  std::uint64_t cause = 0;   ///< number of what led to it, exactly; 0: nothing that is recorded
  std::uint64_t id = 0;      ///< token of a request; link; watch; package; begin of a message
  mote_address mote;         ///< the other mote: destination or source
  std::int32_t peer = 0;     ///< owner of a tuple
  std::uint16_t channel = 0; ///< AM type
  std::string text;          ///< key, status, outcome, name, event, what has begun
  bytes octets;              ///< frame, payload, value
  std::uint32_t count = 0;   ///< transmissions; 1 to_mote or to a further sink, 0 to_pc or to the
                             ///< island's sink; state of an actuator
  bool yes = false;          ///< acked, received, reliable, deleted, plugged, text
  bool unheard = false;      ///< the receiver had ended

  friend bool operator==(const record&, const record&) = default;
};
RUBICON_FIELDS(record, number, time, what, from, to, cause, id, mote, peer, channel, text, octets,
               count, yes, unheard);

/// Names of what the ecology has.
struct island_names {
  std::uint32_t id = 0;
  std::string name;
  std::uint16_t sink = 0;
  std::string gateway;                          ///< name of its peer
  std::map<std::uint16_t, std::string> motes;   ///< without the sink
  std::vector<std::string> aliases;             ///< names of its other gateways' peers (GW-14)
  std::map<std::string, std::uint16_t> doubles; ///< names of second motes, and whose ids they have

  friend bool operator==(const island_names&, const island_names&) = default;
};
RUBICON_FIELDS(island_names, id, name, sink, gateway, motes, aliases, doubles);

struct header {
  std::string ecology;
  std::uint64_t seed = 0;
  std::string file;                 ///< that describes the ecology
  std::string digest;               ///< of its text
  std::vector<std::string> options; ///< of the command line that decide what runs beside these
  duration length{};                ///< of the run, as planned
  bool wall = false;                ///< in wall time: the run cannot be repeated
  std::vector<island_names> islands;
  std::map<std::int32_t, std::string> peers; ///< gateways are peers too
  std::map<std::string, std::string> labels; ///< by names: `kitchen/fan`, `kitchen`, `care-pc`

  friend bool operator==(const header&, const header&) = default;
};
RUBICON_FIELDS(header, ecology, seed, file, digest, options, length, wall, islands, peers, labels);

/// A line, ending in a newline.
[[nodiscard]] std::string encode(const header& x);
[[nodiscard]] std::string encode(const record& x);

/// A whole record.
struct recording {
  explain::header about;
  std::vector<record> records; ///< in the order of the run
  bool cut_off = false;        ///< its last line was incomplete and left out
};

/// What is wrong with the first bad line.
struct bad_line {
  std::size_t line = 0; ///< from 1
  std::string message;

  friend bool operator==(const bad_line&, const bad_line&) = default;
};

/// Takes a record line by line.
class decoder {
public:
  /// @param text without its newline. After a bad line nothing more may be taken.
  [[nodiscard]] std::optional<bad_line> take(std::string_view text);

  /// The record has ended. @param rest what came after the last newline; a run that was killed
  /// leaves half a line
  [[nodiscard]] std::optional<bad_line> finish(std::string_view rest);

  /// What it has taken; whoever needs no more of the records may clear them.
  [[nodiscard]] recording& result() { return result_; }

private:
  std::size_t lines_ = 0;
  recording result_;
};

/// The whole text at once.
struct read_result {
  recording content;
  std::optional<bad_line> problem;
};
[[nodiscard]] read_result read(std::string_view text);

} // namespace rubicon::explain
