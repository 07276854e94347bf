// A program that is a member of one group: it creates or joins it, subscribes and raises events as
// the configuration says (docs/smepp.md).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "smepp/member_config.hpp"
#include "smepp/smepp.hpp"

namespace rubicon::smepp {

struct member_counters {
  std::uint64_t joins = 0;        ///< became a member, by creating, joining or returning
  std::uint64_t joins_failed = 0; ///< the group was not found, or did not let it in
  std::uint64_t subscribed = 0;
  std::uint64_t refused = 0; ///< commands that failed
  std::uint64_t raised = 0;  ///< events
  std::uint64_t received = 0;
  std::uint64_t forwarded = 0; ///< to the gateway
};
RUBICON_FIELDS(member_counters, joins, joins_failed, subscribed, refused, raised, received,
               forwarded);

/// What a member needs of its mote.
class member_host {
public:
  member_host() = default;
  member_host(const member_host&) = delete;
  member_host& operator=(const member_host&) = delete;

  /// The count of a transducer; nothing if there is none.
  [[nodiscard]] virtual std::optional<std::int16_t> read(device::quantity x) = 0;
  /// An event's value is to go to the gateway.
  virtual void forward(std::uint8_t channel, const bytes& value) = 0;
  /// Adds a line to the event log of the run.
  virtual void notify(std::string what) = 0;

protected:
  ~member_host() = default;
};

/// Each call may give commands to the peer; what comes of them is appended to `out`. Times are by
/// the mote's own clock.
class member_program {
public:
  /// Where it acts, for the time of one call.
  struct environment {
    peer& own;
    member_host& host;
    instant now;
    outputs& out;
  };

  /// @param begin of the run, by the mote's own clock
  /// @param description of config.group, with the master key that the mote is provisioned with
  member_program(member_config config, group_description description, instant begin,
                 random_stream rng);

  /// @pre smepp_newPeer has been called
  void start(environment at);
  void on_signal(const signal& x, environment at);
  void on_time(environment at); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] const member_config& config() const { return config_; }
  [[nodiscard]] const member_counters& counters() const { return counters_; }
  /// Nothing while it is no member.
  [[nodiscard]] std::optional<group_id> group() const { return group_; }

private:
  /// Samples for one subscription of another member, or our own.
  struct task {
    subscription_id id;
    const raised_event* what;
    instant due;
  };
  struct planned_subscription {
    std::optional<instant> due; ///< to subscribe, or then to withdraw; nothing: none is due
    bool is_subscribed = false;
  };

  void on(const getGroups_result& x, environment& at);
  void on(const joinGroup_result& x, environment& at);
  void on(const peerJoined& x, environment& at);
  void on(const peerLeft& x, environment& at);
  void on(const subscribed& x, environment& at);
  void on(const unsubscribed& x, environment& at);
  void on(const receive_result& x, environment& at);

  void enter(group_id group, const char* how, environment& at);
  void leave_behind(environment& at);
  void look_again(environment& at);
  void look(environment& at);
  [[nodiscard]] bool is_wanted(const group_description& x) const;
  void try_next(environment& at);
  void subscribe(std::size_t number, environment& at);
  void withdraw(std::size_t number, environment& at);
  void sample(const subscription_info& x, environment& at);
  void raise(task& x, environment& at);
  [[nodiscard]] std::optional<instant> next_sample(const task& x, const environment& at) const;

  member_config config_;
  group_description description_;
  random_stream rng_;
  instant begin_;
  std::optional<group_id> group_;
  group_id joining_;               ///< 0: none
  std::vector<group_id> found_;    ///< to be joined if that one cannot be
  std::optional<instant> look_at_; ///< for the group
  duration pause_;                 ///< to the next look, growing
  std::optional<instant> leave_at_;
  bool has_left_ = false;
  std::vector<planned_subscription> planned_; ///< as config_.subscribes
  std::vector<task> tasks_;
  std::uint32_t number_ = 0; ///< of events without a transducer
  member_counters counters_;
};

} // namespace rubicon::smepp
