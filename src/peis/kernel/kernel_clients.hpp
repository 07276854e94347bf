// The components that share one kernel: what each has asked for, and which of them hears what the
// kernel tells.
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
struct tell_tuple {
  client_id client;
  std::uint64_t watch = 0; ///< the client's own name for it
  tuple_pointer content;   ///< never null
  bool deleted = false;
  provenance from;
};

/// For a port that the client has hooked.
struct tell_message {
  client_id client;
  peer_id source;
  std::uint16_t port = 0;
  payload octets;
  provenance from;
};

/// How a request of the client ended.
struct tell_outcome {
  client_id client;
  std::uint64_t token = 0; ///< the client's own name for it
  bool success = false;
  cause why = cause::none;
  provenance from; ///< the request
};

/// What kernel::subscribed() has become.
struct tell_subscribers {
  client_id client;
  std::vector<std::string> keys; ///< ascending, each once
};

/// What the offset of the kernel's clock has become.
struct tell_clock {
  client_id client;
  duration offset{};
};

/// A client is gone: the kernel is to end this subscription of its.
struct withdraw {
  subscription_id subscription;
};

/// Gives subscriptions and requests of many clients names that one kernel tells apart, and tells
/// each client what is for it under the client's own name. What a client that is gone has wanted is
/// withdrawn: nobody hears of it any more.
class kernel_clients {
public:
  using output =
      std::variant<tell_tuple, tell_message, tell_outcome, tell_subscribers, tell_clock, withdraw>;
  using outputs = std::vector<output>;

  /// Others choose how many keys there are: above so many the next list waits for 10 us a key.
  static constexpr std::size_t keys_unpaced = 100;

  // What clients ask for. Names and tokens are the client's own, and may be in use already.

  [[nodiscard]] subscription_id watch(client_id who, std::uint64_t name); ///< to be subscribed with
  [[nodiscard]] request_id request(client_id who, std::uint64_t token);   ///< to be asked with

  /// Messages for that port are for this client from now on. @returns false: another one has it
  [[nodiscard]] bool hook(client_id who, std::uint16_t port);

  /// Who asked last hears what kernel::subscribed() is, now and after each change (TUP-23).
  [[nodiscard]] outputs watch_subscribers(client_id who, std::string first_part, const kernel& of,
                                          instant now);

  /// All who have asked hear the offset of the clock, now and after each change (CLK-08).
  [[nodiscard]] outputs watch_clock(client_id who, const kernel& of);

  [[nodiscard]] outputs forget(client_id who);

  // What the kernel tells. Nothing comes of what is for nobody.

  [[nodiscard]] outputs on(const tuple_changed& x) const;
  [[nodiscard]] outputs on(const tuple_deleted& x) const;
  [[nodiscard]] outputs on(message x) const;
  [[nodiscard]] outputs on(const outcome& x);

  /// To be called after each call of the kernel, and when deadline() has come.
  [[nodiscard]] outputs review(const kernel& x, instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return subscribers_due_; }

private:
  /// Who hears of a subscription or a request, and under which name of its own.
  struct interest {
    client_id client;
    std::uint64_t name = 0;
    provenance from;
  };

  [[nodiscard]] outputs tell_watch(subscription_id which, const tuple_pointer& content, bool gone,
                                   provenance from) const;
  void review_subscribers(const kernel& x, instant now, outputs& out);

  std::map<subscription_id, interest> watches_;
  std::map<request_id, interest> requests_;
  std::map<std::uint16_t, client_id> ports_;
  std::uint64_t next_watch_ = 1;
  std::uint64_t next_request_ = 1;
  std::optional<client_id> subscribers_watcher_;
  std::string subscribers_first_part_;
  std::vector<std::string> subscribers_told_;
  std::optional<std::uint64_t> subscribers_version_; ///< of what was told
  instant subscribers_told_at_;
  std::optional<instant> subscribers_due_; ///< when they are told again, if a pause is to end
  std::vector<client_id> clock_watchers_;
  std::optional<duration> clock_told_;
};

} // namespace rubicon::peis
