// Subscriptions, the trees they build, and the events that go up these (D1.1 3.4.3, SMP-15 to
// SMP-21).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "smepp/actions.hpp"
#include "smepp/crypto/pairwise.hpp"
#include "smepp/groups/group_management.hpp"

namespace rubicon::smepp {

struct event_config {
  mote_id self;
  std::size_t subscriptions_max = 8; ///< known, ours and others'; more are refused, counted
  std::size_t events_max = 8;        ///< waiting for their hop; the newest is dropped
  std::size_t seen_max = 24;         ///< events remembered; the oldest is forgotten
  std::size_t removed_max = 8;       ///< subscriptions remembered that have been withdrawn
  duration refresh = 30s;            ///< of our subscriptions
  unsigned refreshes_missed = 4;     ///< then a subscription is taken for dead
  unsigned flood_copies = 2;
  unsigned hop_tries = 8;    ///< an event is handed to the radio so often, which itself
                             ///< tries some times; then it is dropped
  duration hop_pause = 60ms; ///< between them, growing
  std::uint8_t hops_max = 32;
  bool authenticates_sender = false; ///< events need a pairwise proof (pairwise.hpp)
};

struct event_counters {
  std::uint64_t raised = 0;     ///< by our application, once for each subscription
  std::uint64_t suppressed = 0; ///< faster than their rate
  std::uint64_t forwarded = 0;
  std::uint64_t repeated = 0; ///< hops tried again
  std::uint64_t received = 0; ///< for our application
  std::uint64_t duplicates = 0;
  std::map<std::string, std::uint64_t> dropped; ///< by cause
};
RUBICON_FIELDS(event_counters, raised, suppressed, forwarded, repeated, received, duplicates,
               dropped);

/// A subscription and our place in its tree.
struct subscription {
  group_id group;
  subscription_id id;
  std::string name;
  group_time made_at;
  group_time expires;  ///< group_time_max: never
  duration interval{}; ///< 0: no rate
  std::uint16_t round = 0;
  std::uint8_t depth = 0; ///< hops to the subscriber; 0: we are it
  mote_id parent = no_mote;
  mote_id other_parent = no_mote;        ///< as near to the subscriber, if one sent this round
  instant refreshed_at;                  ///< when the last round was received, or sent by us
  std::optional<std::int64_t> last_slot; ///< of our own events
  bool is_received = false;              ///< ours: smepp_receive was called
  std::uint32_t every = 1;               ///< ours: our radio wakes for each so many windows (A-64)
};

/// The subscriber floods a subscription in rounds, the first and then refreshes. A member takes for
/// parent the neighbour over which the newest round came with the fewest hops: its depth is its
/// distance. An event goes from parent to parent, each hop acknowledged by the radio; if one is
/// gone, over another as near, and with the next round the tree is whole again.
class event_management {
public:
  event_management() = default;
  event_management(event_config config, random_stream rng);

  // ---- what the application wants. @pre the group's time is known

  /// @param rate in 1/s; 0: none
  [[nodiscard]] std::optional<failure> subscribe(const group& g, const std::string& name,
                                                 std::optional<duration> expiration, double rate,
                                                 context c);
  /// @param name empty: all of ours in the group
  [[nodiscard]] std::optional<failure> unsubscribe(group_id group, const std::string& name,
                                                   context c);
  [[nodiscard]] std::optional<failure> event(const group& g, const std::string& name,
                                             const bytes& value, context c);
  /// @param frequency in 1/s; 0: that of the subscription
  [[nodiscard]] std::optional<failure> receive(group_id group, const std::string& name,
                                               double frequency);
  bool set_pairwise_key(mote_id other, const key& x) { return pairwise_.set(other, x); }

  // ---- what has come

  void on_message(mote_id from, const smepp::subscribe& x, const group& g, context c);
  void on_message(mote_id from, const smepp::unsubscribe& x, const group& g, context c);
  void on_message(mote_id from, const smepp::event& x, const group& g, context c);
  /// The hop with this token has ended.
  void on_sent(std::uint64_t token, bool acked, context c);
  void on_left(mote_id peer, group_id group, context c);
  void on_group_gone(group_id group, context c);

  /// Times of the group decide.
  void on_time(const group_management& groups, context c);
  [[nodiscard]] std::optional<instant> deadline(const group_management& groups) const;

  /// For a newcomer.
  void introduce(const newcomer& x, context c) const;

  // ---- what is known

  [[nodiscard]] const std::vector<subscription>& all() const { return subscriptions_; }
  [[nodiscard]] const subscription* find(group_id group, subscription_id id) const;
  [[nodiscard]] std::size_t count(group_id group) const;
  [[nodiscard]] static subscription_info info(const subscription& x, const group& g);
  [[nodiscard]] const event_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t waiting_events() const { return queue_.size(); }
  [[nodiscard]] std::size_t footprint() const;

private:
  struct waiting {
    group_id group;
    smepp::event what;
    unsigned tries = 0;
    instant due;
    std::uint64_t token = 0; ///< not 0: handed out
    provenance from = {};
  };
  struct mark {
    group_id group;
    subscription_id id;
    mote_id producer;
    std::uint16_t sequence = 0;
    /// Of proof and value: what is forged in the producer's name is another event. Nothing else
    /// distinguishes them on the route to a member that can check the proof.
    std::uint16_t content = 0;

    friend bool operator==(const mark&, const mark&) = default;
  };
  struct removed {
    group_id group;
    subscription_id id;
    group_time made_at;
  };

  [[nodiscard]] subscription* find(group_id group, subscription_id id);
  [[nodiscard]] bool is_removed(group_id group, const smepp::subscribe& x) const;
  void spread(const subscription& x, bool is_refresh, context c) const;
  void remove(std::size_t at, bool is_announced, context c);
  void take(const smepp::event& x, const subscription& to, bool is_own, context c);
  void enqueue(group_id group, smepp::event x, context c);
  void pump(context c);
  [[nodiscard]] bool is_new(group_id group, const smepp::event& x);
  void drop(const char* why) { ++counters_.dropped[why]; }
  template <class Which>
  void forget(Which which) {
    if (const auto lost = std::erase_if(queue_, which); lost > 0)
      counters_.dropped["no_subscription"] += lost;
  }

  event_config config_;
  random_stream rng_;
  pairwise_keys pairwise_;
  std::vector<subscription> subscriptions_;
  std::vector<waiting> queue_;
  std::vector<mark> seen_;
  std::vector<removed> removed_;
  std::uint16_t sequence_ = 0;
  std::uint64_t token_ = 0;
  std::uint8_t number_ = 0;
  event_counters counters_;
};

} // namespace rubicon::smepp
