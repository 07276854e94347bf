// For files of this room only: where a network command works.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cli/exit_status.hpp"
#include "cli/guest.hpp"
#include "io/loop.hpp"

namespace rubicon::cli {

/// Of one command, while it runs.
struct visit {
  io::loop& loop;
  const network_options& with;
  guest& self;

  [[nodiscard]] peer::standalone& peer() const { return self.peer(); }
};

/// A subscription for as long as somebody listens: the guest says goodbye after its command has
/// ended, and still hears of changes.
class listening {
public:
  using callback = peer::standalone::tuple_callback;

  listening(const visit& at, peer_id owner, std::string_view pattern, callback changed,
            callback deleted = {})
      : peer_(at.peer()),
        watch_(peer_.subscribe(owner, pattern, std::move(changed), std::move(deleted))) {}
  ~listening() {
    if (const auto* id = std::get_if<peis::subscription_id>(&watch_))
      peer_.unsubscribe(*id);
  }
  listening(const listening&) = delete;
  listening& operator=(const listening&) = delete;

  /// Why it hears nothing; nullptr if it does.
  [[nodiscard]] const peis::cause* refused() const { return std::get_if<peis::cause>(&watch_); }

private:
  peer::standalone& peer_;
  peer::standalone::watch_result watch_;
};

/// One line on standard error.
[[nodiscard]] exit_status fail(const std::string& why);

/// Prints the result of a command.
[[nodiscard]] exit_status answer(const std::string& text);

// find_peer.cpp
/// Waits until it is there. @returns its id, or why it is not known
[[nodiscard]] std::variant<peer_id, std::string> find_peer(const visit& at, const peer_wish& x);
/// The same; of any, the one who has a tuple of one of these keys.
[[nodiscard]] std::variant<peer_id, std::string> find_owner(const visit& at, const peer_wish& x,
                                                            const std::vector<std::string>& keys);
/// `care-pc@basement!4711`, as it calls itself; empty if it has not.
[[nodiscard]] std::string name_of(const visit& at, peer_id host);

// tuple_commands.cpp
[[nodiscard]] exit_status perform(const visit& at, const get_tuple& x);
[[nodiscard]] exit_status perform(const visit& at, const write_tuple& x);
[[nodiscard]] exit_status perform(const visit& at, const delete_tuple& x);
[[nodiscard]] exit_status perform(const visit& at, const meta_tuple& x);
[[nodiscard]] exit_status perform(const visit& at, const list_tuples& x);
[[nodiscard]] exit_status perform(const visit& at, const watch_tuples& x);

// graph_command.cpp
[[nodiscard]] exit_status perform(const visit& at, const show_graph& x);

// top_command.cpp
[[nodiscard]] exit_status perform(const visit& at, const show_top& x);

// host_commands.cpp
[[nodiscard]] exit_status perform(const visit& at, const list_hosts& x);
[[nodiscard]] exit_status perform(const visit& at, const trace_route& x);
[[nodiscard]] exit_status perform(const visit& at, const ping_host& x);

} // namespace rubicon::cli
