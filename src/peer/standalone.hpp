// A PEIS kernel that a program drives by itself: the calls of D1.1 3.1.3 over real links, without
// actors or threads (SCH-05).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "io/loop.hpp"
#include "peer/tcp_links.hpp"
#include "peis/kernel/kernel.hpp"

namespace rubicon::peer {

struct standalone_config {
  /// What is empty or 0 is filled in: host name, process, addresses, link window, and the clock
  /// offset with the Unix time. `network.id` must be 1..65535.
  peis::kernel_config kernel;
  links_config links;
  std::optional<std::uint64_t> seed; ///< of ids and other random numbers; unset: from the system
  /// Called with what a person should know: steps that come too rarely, callbacks that take too
  /// long, links that failed. May be empty.
  std::function<void(const std::string&)> on_warning;
};

/// Everything happens in step() and in the calls that wait, on the thread that calls them: it owns
/// the peer. Callbacks may call anything but leave(); what they wait for is served meanwhile.
///
/// Calls that wait take a timeout and step the peer meanwhile. A peer that is not stepped at least
/// 20 times a second keeps others waiting.
class standalone : private link_user {
public:
  using tuple_callback = std::function<void(const peis::tuple_pointer&)>;
  using outcome_callback = std::function<void(const peis::outcome&)>;
  using message_callback = std::function<void(const peis::message&)>;
  using watch_result = std::variant<peis::subscription_id, peis::cause>;
  /// A host can be reached and described, or cannot any more.
  using host_callback = std::function<void(peer_id host, bool is_there)>;

  /// Steps must not be further apart (D1.1 3.1.4).
  static constexpr duration step_gap_max = 50ms;
  static constexpr duration callback_max = 50ms; ///< CB-03, NFR-09
  static constexpr duration warning_gap = 10s;   ///< between two warnings of one kind

  /// Listens and starts the kernel.
  /// @param where must outlive the peer
  /// @returns why it cannot listen, if it cannot
  [[nodiscard]] static std::variant<std::unique_ptr<standalone>, std::string>
  open(io::loop& where, standalone_config config);

  /// Closes the links without a goodbye; see leave().
  ~standalone() override;

  // Driving.

  /// Does what is due; waits at most `wait_max` for something to happen, and is back at once when
  /// something has.
  void step(duration wait_max);

  /// Steps until `done`, which is asked after each step.
  /// @returns what it said last
  bool run_until(const std::function<bool()>& done, duration timeout);

  /// Attempts a link to `tcp://host:port`, once (TCP-04). Links that are always to be there belong
  /// into the configuration. A failure is a warning.
  void connect(const std::string& url);

  /// Says goodbye, lets queued octets leave for up to 2 s and closes all links (KH-04).
  void leave();

  /// An authorised peer has asked this one to end (TUP-22): call leave() soon.
  [[nodiscard]] bool quit_requested() const { return quit_requested_; }

  [[nodiscard]] instant now() const; ///< since open()
  [[nodiscard]] peis::timestamp network_time() const { return kernel_.network_time(now()); }

  // Tuples. Names in brackets are those of D1.1 3.1.3; the causes are described in
  // peis/kernel/kernel.hpp.

  /// [setTuple] Sets one of our own.
  [[nodiscard]] peis::cause set_tuple(std::string_view key, peis::tuple_content content);
  [[nodiscard]] peis::cause delete_tuple(std::string_view key);

  /// [insertTuple] Sets a tuple with all its fields. `then` is called once with how it ended; what
  /// is known at once is returned as well.
  peis::cause insert_tuple(peis::tuple draft, outcome_callback then = {});

  /// [appendTupleByAbstract] Adds to what matches.
  peis::cause append_tuple(const peis::prototype& wanted, payload added,
                           outcome_callback then = {});

  /// [setRemoteTuple] Asks its owner.
  peis::cause set_remote_tuple(peer_id owner, std::string_view key, peis::tuple_content content,
                               outcome_callback then = {});
  peis::cause delete_remote_tuple(peer_id owner, std::string_view key, outcome_callback then = {});

  /// [subscribe, subscribeByAbstract] `changed` is called for each set, `deleted` for each end.
  /// @returns the handle, or why there is none
  [[nodiscard]] watch_result subscribe(peer_id owner, std::string_view pattern,
                                       tuple_callback changed = {}, tuple_callback deleted = {});
  [[nodiscard]] watch_result subscribe(const peis::prototype& wanted, tuple_callback changed = {},
                                       tuple_callback deleted = {});
  /// [registerTupleCallback, ...ByAbstract] The same for what others have subscribed to.
  [[nodiscard]] watch_result register_callback(const peis::prototype& wanted,
                                               tuple_callback changed, tuple_callback deleted = {});
  void unsubscribe(peis::subscription_id id);

  /// [getTuple, getTupleByAbstract] What is held here.
  [[nodiscard]] peis::reading get_tuple(peer_id owner, std::string_view key,
                                        peis::read_mode mode = peis::read_mode::keep_old);
  [[nodiscard]] peis::reading get_tuple(const peis::prototype& wanted,
                                        peis::read_mode mode = peis::read_mode::keep_old);
  /// [getTuple, blocking] Waits until it is here. Needs a subscription, except for own tuples.
  [[nodiscard]] peis::reading get_tuple(peer_id owner, std::string_view key, peis::read_mode mode,
                                        duration timeout);
  /// [getTuples, getTuplesByAbstract] Appends what is held here.
  void get_tuples(const peis::prototype& wanted, peis::result_set& into,
                  peis::read_mode mode = peis::read_mode::keep_old);

  [[nodiscard]] bool has_subscriber(std::string_view key) const;

  /// Does the present value of an own tuple still wait for room to be sent to a subscriber?
  /// set_tuple() never waits: the next value takes its place.
  [[nodiscard]] bool is_waiting(std::string_view key) const { return kernel_.is_waiting(key); }

  // Messages.

  /// [sendMessage] To one port of one peer.
  peis::cause send_message(std::uint16_t port, peer_id destination, payload octets, bool reliable,
                           peis::priority class_of_service = peis::priority::normal,
                           outcome_callback then = {});

  /// [broadcast] To everybody.
  [[nodiscard]] peis::cause broadcast(std::uint16_t port, payload octets);

  /// [registerHook] Several hooks of a port are called in the order they came in.
  /// @returns false unless the port is 20..49
  [[nodiscard]] bool register_hook(std::uint16_t port, message_callback hook);

  /// [registerHook] The same for packages that pass through here to others (API-06): one
  /// hook a port, which may consume them.
  [[nodiscard]] bool register_transit_hook(std::uint16_t port, peis::transit_hook hook) {
    return kernel_.hook_transit(port, std::move(hook));
  }

  // Hosts.

  /// [hostInfoHT] All known hosts, ourselves included, ascending by id; valid until the next call
  /// that is not const.
  [[nodiscard]] std::vector<const peis::host_record*> hosts() const { return kernel_.hosts(); }
  [[nodiscard]] bool reachable(peer_id host) const { return kernel_.reachable(host); }
  void on_host_change(host_callback x) { on_host_ = std::move(x); }

  /// The peers on the route to a host and back, ourselves first (API-12). nullopt: none came back.
  [[nodiscard]] std::optional<std::vector<peer_id>> trace(peer_id destination, duration timeout);

  // Everything else.

  /// Calls `f` in a step every `period`, from now on; in each step if that is 0 (SCH-03). Times
  /// that were missed are not made up for (SCH-02).
  /// @pre period >= 0
  void run_every(duration period, std::function<void()> f);

  /// The waiting form of every call that takes an `outcome_callback`: begins it and waits for its
  /// end. `peer.await(5s, [&](auto then) { peer.set_remote_tuple(7, "a", x, then); })`
  /// @returns nothing if the time was not enough
  [[nodiscard]] std::optional<peis::cause>
  await(duration timeout, const std::function<void(outcome_callback)>& begin);

  /// Any other command of the kernel.
  /// @returns why it failed, if that is known at once
  peis::cause
  call(const std::function<peis::outputs(peis::kernel&, peis::request_id, instant)>& command,
       outcome_callback then = {});

  [[nodiscard]] const peis::kernel& kernel() const { return kernel_; }
  [[nodiscard]] const tcp_links& links() const { return *links_; }

private:
  struct watcher {
    tuple_callback changed;
    tuple_callback deleted;
  };
  struct periodic {
    duration period;
    instant next;
    std::function<void()> f;
  };
  /// How often one kind of warning is given.
  struct rate_limiter {
    std::optional<instant> last;
  };

  standalone(io::loop& where, standalone_config config);
  void start(std::unique_ptr<tcp_links> links);

  void on_link_open(peis::link_id link, peis::link_role role,
                    std::optional<peis::attempt_id> attempt) override;
  void on_attempt_failed(peis::attempt_id attempt, const std::string& why) override;
  void on_link_octets(peis::link_id link, byte_view octets) override;
  void on_link_sent(peis::link_id link, std::size_t octets) override;
  void on_link_closed(peis::link_id link, const std::string& why) override;
  void on_announcement(byte_view datagram, const ipv4_address& from) override;
  void on_addresses() override;

  void perform(peis::outputs todo);
  void run_periodics();
  void drain();
  void handle(peis::to_link& x) { links_->carry_out(std::move(x)); }
  void handle(peis::close_link& x);
  void handle(const peis::read_link& x) { links_->carry_out(x); }
  void handle(const peis::pace_link& x) { links_->carry_out(x); }
  void handle(peis::connect_to& x) { links_->carry_out(x); }
  void handle(peis::announce& x) { links_->carry_out(x); }
  void handle(peis::tuple_changed& x);
  void handle(peis::tuple_deleted& x);
  void handle(peis::message& x);
  void handle(peis::outcome& x);
  void handle(peis::host_appeared& x);
  void handle(peis::host_vanished& x);
  void handle(peis::quit_requested& x);

  void handle(peis::traced& x);
  void handle(peis::id_taken& x);
  void handle(const peis::namesake_found& x);
  static void handle(const peis::debug_requested&) {} // it has no debug log
  static void handle(const peis::intercepted&) {}     // by a hook of the program itself
  static void handle(const peis::scan_adapter&) {}
  static void handle(const peis::say_hello&) {} // without adapters

  using watch_command =
      std::function<peis::outputs(peis::subscription_id, peis::request_id, instant)>;
  [[nodiscard]] watch_result watch(const watch_command& command, tuple_callback changed,
                                   tuple_callback deleted);
  [[nodiscard]] io::loop::time_point real(instant x) const;
  void check_step_gap();
  void warn(rate_limiter& kind, const std::string& text);
  template <class F>
  void call_user(const char* what, F&& f);

  io::loop* loop_;
  standalone_config config_;
  io::loop::time_point start_;
  std::unique_ptr<tcp_links> links_;
  peis::kernel kernel_;
  bool quit_requested_ = false;

  std::deque<peis::output> todo_; ///< outputs in their order, though callbacks make new ones
  bool addresses_are_given_ = false;
  bool draining_ = false;

  std::map<peis::subscription_id, std::shared_ptr<watcher>> watchers_;
  std::map<peis::request_id, outcome_callback> expected_;
  std::map<peis::request_id, std::vector<peer_id>> traces_; ///< that somebody waits for
  std::map<std::uint16_t, std::vector<message_callback>> hooks_;
  host_callback on_host_;
  std::deque<periodic> periodics_; ///< those there stay where they are when one adds another
  std::uint64_t next_subscription_ = 1;
  std::uint64_t next_request_ = 1;
  std::uint64_t next_attempt_;

  std::optional<instant> last_step_;
  rate_limiter rare_steps_;
  rate_limiter slow_callback_;
  rate_limiter failed_attempt_;
  rate_limiter taken_id_;
};

} // namespace rubicon::peer
