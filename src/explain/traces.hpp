// The content of a record, put together: each message and each value of a tuple with its path.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "explain/print/names.hpp"
#include "explain/record.hpp"

namespace rubicon::explain {

using node_index = std::uint32_t;
inline constexpr node_index no_node = std::numeric_limits<node_index>::max();

/// One step of a trace.
enum class step : std::uint8_t {
  sends,    ///< a message begins
  hop,      ///< over one medium from one actor to another
  receives, ///< a program is given the message
  acts,     ///< an actuator, or whoever notes an event
  learns,   ///< the sending program is notified how it ended
  asks,     ///< a component wants a tuple of another peer to be set
  sets,     ///< a tuple has a new value at its owner, or is deleted
  notified, ///< a component receives the value
};

enum class medium : std::uint8_t { none, air, serial, backbone, peis };

/// What a hop carries.
enum class cargo : std::uint8_t {
  content,         ///< the message or the value itself
  greeting,        ///< the question which incarnation the receiver is
  answer,          ///< back to the sender: acknowledgement, busy, refused
  greeting_answer, ///< back to the sender
};

/// One frame on the air, one write to a line or backbone, one package on a link.
struct attempt {
  instant begin;
  std::string outcome; ///< `delivered`, or why not
  bool arrived = false;
};

/// Whose trace a step belongs to.
struct subject {
  bool is_tuple = false;
  std::uint32_t index = 0; ///< of messages() or tuples()

  friend bool operator==(subject, subject) = default;
};

struct node {
  step what = step::sends;
  subject about;
  medium over = medium::none;
  cargo of = cargo::content;
  std::string from; ///< actor path; who does it, for steps that are no hops
  std::string to;   ///< actor path or, for a frame to all, empty
  instant begin;
  std::optional<instant> arrived;     ///< at `to`; set for steps that are no hops
  std::vector<std::string> receivers; ///< of a frame to all
  peer_id towards = any_peer;         ///< whom a package is for in the end
  std::vector<attempt> attempts;
  std::string failure;         ///< how the radio or kernel gave up; empty: it did not
  std::uint32_t fragments = 1; ///< that it was cut into
  std::string text;            ///< event; kind of an answer; cause of a failure
  node_index parent = no_node;
  std::vector<node_index> children; ///< in order of time

  /// When it shows: on arrival, or when it was tried last.
  [[nodiscard]] instant time() const;
};

/// What the account of the run says of a message (core/account/message_ledger.hpp).
struct message_ending {
  instant at;
  bool arrived = false;
  std::string cause; ///< of its loss; `handed_over`: to another process
  std::string place; ///< actor path
};

/// A message between two motes, gateways or PCs.
struct message {
  mote_address source;
  mote_address destination;
  std::uint16_t channel = 0; ///< AM type, or above 255
  bool is_reliable = false;
  bool is_on_channel = false;   ///< a stream's record or a synaptic vector, on a channel of Network
  bool is_in_tunnel = false;    ///< the same in transit to another island or PC
  std::optional<bytes> content; ///< nothing: never seen as a whole
  std::string name;             ///< `kitchen/climate-7#12`
  std::string program;          ///< actor path; empty: unknown
  node_index root = no_node;
  std::vector<node_index> nodes; ///< in order of time
  std::uint32_t sends = 0;       ///< attempts of Transport, greetings not counted
  std::optional<instant> delivered;
  std::optional<instant> acknowledged; ///< the answer has reached the sender
  std::optional<instant> failed;       ///< the sender was notified, or refused it
  bool refused = false;                ///< at once
  bool turned_away = false;            ///< by the receiver, which was busy or did not know us
  bool is_accounted = false;           ///< the run's account has it, so its ending is recorded
  std::optional<message_ending> ending;
};

/// A value that a tuple has had.
struct tuple_value {
  peer_id owner;
  std::string key;
  bytes value; ///< text without its trailing NUL
  bool is_text = false;
  bool is_deletion = false;
  std::string writer;         ///< actor path
  std::optional<instant> set; ///< at its owner; nothing: it never got there
  node_index root = no_node;  ///< `asks` or `sets`
  node_index at_owner = no_node;
  std::vector<node_index> nodes;

  [[nodiscard]] instant begun(const std::vector<node>& all) const { return all[root].begin; }
};

/// A subscriber to tuples.
struct watcher {
  std::string who; ///< actor path
  std::int32_t owner = 0;
  std::string pattern;
  instant since;
};

struct traces {
  header about;
  names known;
  std::vector<node> nodes;
  std::vector<message> messages; ///< in order of their beginning
  std::vector<tuple_value> tuples;
  std::vector<watcher> watchers;
  std::map<std::string, instant> last_notified; ///< of a tuple, by actor path
  std::vector<record> events;                   ///< faults and what came of them
  std::string ecology;                          ///< what `view` has written of the ecology,
  std::vector<std::string> samples;             ///< and of each moment that it has looked at
  instant end;                                  ///< of the record
  bool cut_off = false;
};

/// Follows everything in a record. Costs O(n log n); what octets mean that no decoder takes is left
/// out.
[[nodiscard]] traces follow(const recording& x);

/// The same bit by bit, of a record that is still written.
class following {
public:
  /// @param keeps_view whether traces::ecology and samples are wanted, which are long
  explicit following(const header& about, bool keeps_view = true);
  ~following();
  following(following&&) noexcept;
  following& operator=(following&&) noexcept;

  void take(const record& x);
  [[nodiscard]] const traces& so_far() const;

  /// Nothing more comes. @param cut_off the last line was incomplete
  [[nodiscard]] traces finish(bool cut_off);

private:
  class follower;
  std::unique_ptr<follower> all_;
};

} // namespace rubicon::explain
