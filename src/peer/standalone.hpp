// A PEIS kernel that a program drives by itself: the calls of D1.1 3.1.3 over real links, without
// actors or threads (SCH-05).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "io/loop.hpp"
#include "peer/callback_table.hpp"
#include "peer/callbacks.hpp"
#include "peer/message_calls.hpp"
#include "peer/tcp_links.hpp"
#include "peer/tuple_calls.hpp"
#include "peer/warnings.hpp"
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
  /// Steps must not be further apart (D1.1 3.1.4).
  static constexpr duration step_gap_max = 50ms;
  static constexpr duration callback_max = 50ms; ///< CB-03, NFR-09

  /// Listens and starts the kernel.
  /// @param where must outlive the peer
  /// @returns why it cannot listen, if it cannot
  [[nodiscard]] static std::variant<std::unique_ptr<standalone>, std::string>
  open(io::loop& where, standalone_config config);

  /// Closes the links without the broadcast of an exit; see leave().
  ~standalone() override;

  // Driving.

  /// Does what is due; waits at most `wait_max` for something to happen, and is back at once when
  /// something has.
  void step(duration wait_max);

  /// Steps until `done`, which is asked after each step.
  /// @returns what it returned last
  bool run_until(const std::function<bool()>& done, duration timeout);

  /// Calls `f` in a step every `period`, from now on; in each step if that is 0 (SCH-03). Times
  /// that were missed are not made up for (SCH-02).
  /// @pre period >= 0
  void run_every(duration period, std::function<void()> f);

  /// Attempts a link to `tcp://host:port`, once (TCP-04). Links that are always to be there belong
  /// into the configuration. A failure is a warning.
  void connect(const std::string& url);

  /// Broadcasts the exit, lets queued octets leave for up to 2 s and closes all links (KH-04).
  void leave();

  /// An authorised peer has asked this one to end (TUP-22): call leave() soon.
  [[nodiscard]] bool quit_requested() const { return quit_requested_; }

  [[nodiscard]] instant now() const; ///< since open()

  // Commands.

  [[nodiscard]] tuple_calls tuples() { return {*this, kernel_, callbacks_}; }
  [[nodiscard]] message_calls messages() { return {*this, kernel_, callbacks_}; }

  /// Any command of the kernel.
  /// @returns why it failed, if that is known at once
  peis::cause
  call(const std::function<peis::outputs(peis::kernel&, peis::request_id, instant)>& command,
       outcome_callback then = {});

  /// The waiting form of every call that takes an `outcome_callback`: begins it and waits for its
  /// end. `peer.await(5s, [&](auto then) { peer.tuples().set_remote(7, "a", x, then); })`
  /// @returns nothing if the time was not enough
  [[nodiscard]] std::optional<peis::cause>
  await(duration timeout, const std::function<void(outcome_callback)>& begin);

  void on_host_change(host_callback x) { callbacks_.set_host_callback(std::move(x)); }

  // Looking.

  [[nodiscard]] const peis::kernel& kernel() const { return kernel_; }
  /// [hostInfoHT] Hosts, links and routes as the kernel knows them; records are valid until the
  /// next call that is not const.
  [[nodiscard]] peis::p2p_view network() const { return kernel_.network(); }
  [[nodiscard]] const tcp_links& links() const { return *links_; }

private:
  struct periodic {
    duration period;
    instant next;
    std::function<void()> f;
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

  [[nodiscard]] io::loop::time_point real(instant x) const;
  void check_step_gap();
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

  callback_table callbacks_;
  std::deque<periodic> periodics_; ///< those there stay where they are when one adds another
  std::uint64_t next_attempt_;
  std::optional<instant> last_step_;
  warnings warnings_;
};

} // namespace rubicon::peer
