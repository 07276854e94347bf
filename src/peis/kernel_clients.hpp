// The components that share one kernel: what each has requested, and which of them is notified of
// which output of the kernel.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/kernel/kernel.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

struct client_tag;

/// A component that uses a kernel, named by the kernel's owner; never used twice by the same owner.
using client_id = strong_id<client_tag, std::uint64_t>;

/// A watched tuple was set, or is gone.
struct tuple_notice {
  client_id client;
  std::uint64_t watch = 0; ///< the client's own name for it
  tuple_pointer content;   ///< never null
  bool deleted = false;
  provenance from;
};

/// For a port that the client has hooked.
struct message_notice {
  client_id client;
  peer_id source;
  std::uint16_t port = 0;
  payload octets;
  provenance from;
};

/// How a request of the client ended.
struct outcome_notice {
  client_id client;
  std::uint64_t token = 0; ///< the client's own name for it
  bool success = false;
  cause why = cause::none;
  provenance from; ///< the request
};

/// What tuple_reader::subscribed() has become.
struct subscribers_notice {
  client_id client;
  std::vector<std::string> keys; ///< ascending, each once
};

/// What the offset of the kernel's clock has become.
struct clock_notice {
  client_id client;
  duration offset{};
};

/// A client is gone: the kernel is to end this subscription of its.
struct withdraw {
  subscription_id subscription;
};

/// Gives subscriptions and requests of many clients names that are unique in one kernel, and
/// notifies each client under the client's own names. Subscriptions of a client that is gone are
/// withdrawn; what comes for it nevertheless is dropped.
class kernel_clients {
public:
  using output = std::variant<tuple_notice, message_notice, outcome_notice, subscribers_notice,
                              clock_notice, withdraw>;
  using outputs = std::vector<output>;

  /// Others choose how many keys there are: above so many the next list waits for 10 us a key.
  static constexpr std::size_t keys_unpaced = 100;

  // What clients request. Names and tokens are the client's own, and may be in use already.

  [[nodiscard]] subscription_id watch(client_id who, std::uint64_t name); ///< to be subscribed with
  [[nodiscard]] request_id request(client_id who, std::uint64_t token);   ///< to be requested with

  /// Messages for that port are for this client from now on. @returns false: another one has it
  [[nodiscard]] bool hook(client_id who, std::uint16_t port);

  /// The last client that called it is notified of tuple_reader::subscribed(), now and after each
  /// change (TUP-23).
  [[nodiscard]] outputs watch_subscribers(client_id who, std::string first_part, const kernel& of,
                                          instant now);

  /// All clients that called it are notified of the offset of the clock, now and after each change
  /// (CLK-08).
  [[nodiscard]] outputs watch_clock(client_id who, const kernel& of);

  [[nodiscard]] outputs forget(client_id who);

  // Outputs of the kernel. What no client has requested has no effect.

  [[nodiscard]] outputs on(const tuple_changed& x) const;
  [[nodiscard]] outputs on(const tuple_deleted& x) const;
  [[nodiscard]] outputs on(message x) const;
  [[nodiscard]] outputs on(const outcome& x);

  /// To be called after each call of the kernel, and when deadline() has come.
  [[nodiscard]] outputs review(const kernel& x, instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return subscribers_due_; }

private:
  /// The client of a subscription or a request, and its own name for it.
  struct interest {
    client_id client;
    std::uint64_t name = 0;
    provenance from;
  };

  [[nodiscard]] outputs notify_watch(subscription_id which, const tuple_pointer& content, bool gone,
                                     provenance from) const;
  void review_subscribers(const kernel& x, instant now, outputs& out);

  std::map<subscription_id, interest> watches_;
  std::map<request_id, interest> requests_;
  std::map<std::uint16_t, client_id> ports_;
  std::uint64_t next_watch_ = 1;
  std::uint64_t next_request_ = 1;
  std::optional<client_id> subscribers_watcher_;
  std::string subscribers_first_part_;
  std::vector<std::string> subscribers_sent_;
  std::optional<std::uint64_t> subscribers_version_; ///< of what was sent
  instant subscribers_sent_at_;
  std::optional<instant> subscribers_due_; ///< when the next list is sent, if a pause is to end
  std::vector<client_id> clock_watchers_;
  std::optional<duration> clock_sent_;
};

} // namespace rubicon::peis
