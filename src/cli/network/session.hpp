// For files of this room only: the context of a network command.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cli/network/temporary_peer.hpp"
#include "cli/words/exit_status.hpp"
#include "io/loop.hpp"

namespace rubicon::cli {

/// Of one command, while it runs.
struct session {
  io::loop& loop;
  const network_options& with;
  temporary_peer& self;

  [[nodiscard]] peer::standalone& peer() const { return self.peer(); }
};

/// A subscription that ends with its scope: the temporary peer leaves after its command has
/// ended, and is notified of changes until then.
class scoped_subscription {
public:
  using callback = peer::tuple_callback;

  scoped_subscription(const session& at, peer_id owner, std::string_view pattern, callback changed,
                      callback deleted = {})
      : peer_(at.peer()),
        watch_(peer_.tuples().subscribe(owner, pattern, std::move(changed), std::move(deleted))) {}
  ~scoped_subscription() {
    if (const auto* id = std::get_if<peis::subscription_id>(&watch_))
      peer_.tuples().unsubscribe(*id);
  }
  scoped_subscription(const scoped_subscription&) = delete;
  scoped_subscription& operator=(const scoped_subscription&) = delete;

  /// Why it was refused; nullptr if it was not.
  [[nodiscard]] const peis::cause* refused() const { return std::get_if<peis::cause>(&watch_); }

private:
  peer::standalone& peer_;
  peer::watch_result watch_;
};

/// One line on standard error.
[[nodiscard]] exit_status fail(const std::string& why);

/// Prints the result of a command.
[[nodiscard]] exit_status answer(const std::string& text);

// find_peer.cpp
/// Waits until it is there. @returns its id, or why it is not known
[[nodiscard]] std::variant<peer_id, std::string> find_peer(const session& at,
                                                           const peer_selector& x);
/// The same; of any, the one who has a tuple of one of these keys.
[[nodiscard]] std::variant<peer_id, std::string>
find_owner(const session& at, const peer_selector& x, const std::vector<std::string>& keys);
/// `care-pc@basement!4711`, as it calls itself; empty if it has not.
[[nodiscard]] std::string name_of(const session& at, peer_id host);

// tuple_commands.cpp
[[nodiscard]] exit_status perform(const session& at, const get_tuple& x);
[[nodiscard]] exit_status perform(const session& at, const wait_for_tuple& x);
[[nodiscard]] exit_status perform(const session& at, const write_tuple& x);
[[nodiscard]] exit_status perform(const session& at, const delete_tuple& x);
[[nodiscard]] exit_status perform(const session& at, const meta_tuple& x);
[[nodiscard]] exit_status perform(const session& at, const list_tuples& x);
[[nodiscard]] exit_status perform(const session& at, const watch_tuples& x);

// graph_command.cpp
[[nodiscard]] exit_status perform(const session& at, const show_graph& x);

// top_command.cpp
[[nodiscard]] exit_status perform(const session& at, const show_top& x);

// host_commands.cpp
[[nodiscard]] exit_status perform(const session& at, const list_hosts& x);
[[nodiscard]] exit_status perform(const session& at, const trace_route& x);
[[nodiscard]] exit_status perform(const session& at, const ping_host& x);

} // namespace rubicon::cli
