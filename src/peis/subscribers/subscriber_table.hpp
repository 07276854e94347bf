// What other hosts have subscribed to here, and how much of it there may be (TUP-08, TUP-10).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "peis/link/fair_share.hpp"
#include "peis/subscribers/subscription_index.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::peis {

/// A subscription of another host.
struct subscriber {
  peer_id host;
  prototype wanted;
  std::optional<instant> expiry; ///< unset for real kernels
  std::uint64_t number = 0;      ///< ascending in the order in which they came
  std::size_t weight = 0;        ///< octets, with all that surrounds it
  bool again = false;            ///< asked for once more while what matches is being sent
};

/// Everything another host can put here takes a share of a limit, in records and in octets. All
/// that concerns one record costs the logarithm of their number, all that concerns a host what it
/// has here.
class subscriber_table {
public:
  struct limits {
    std::size_t records = 0;
    std::size_t octets = 0;
    std::shared_ptr<fair_share> pool = nullptr; ///< of octets, with other tables
    std::size_t per_key = 0; ///< of one host, for one key or pattern: prototypes differ otherwise
  };
  using records = std::map<std::uint64_t, subscriber*>; ///< by number

  subscriber_table() = default;
  explicit subscriber_table(const limits& x);

  /// The record of an equal subscription; null if there is none.
  [[nodiscard]] subscriber* find(peer_id host, const prototype& wanted);

  /// @returns the record, which stays where it is until it is erased; null if there is no room
  /// @pre find() knows none
  subscriber* add(peer_id host, const prototype& wanted, std::optional<instant> expiry);

  /// Removes those of a host for this owner (or any_peer) and key. @returns their numbers
  std::vector<std::uint64_t> erase(peer_id host, peer_id owner, const key& wanted);

  /// Removes all of a host. @returns how many
  std::size_t erase_host(peer_id host);

  /// Removes a record that find() or add() has returned.
  void erase(const subscriber& x);

  /// Those of one host whose time has come, and whether others of any host have a time.
  struct expired {
    std::vector<subscriber*> gone; ///< to be erased, in no order that shows
    bool mortal = false;
  };
  [[nodiscard]] expired find_expired(instant now);

  /// Calls `visit(const subscriber&)` for each whose key or pattern covers `name`.
  template <class Visitor>
  void for_matching(const key& name, Visitor visit) const {
    index_.for_matching(name, [&](const subscriber* x) { visit(*x); });
  }
  template <class Visitor>
  void for_all(Visitor visit) const {
    index_.for_all([&](const subscriber* x) { visit(*x); });
  }
  template <class Visitor>
  void for_first_part(std::string_view first_part, Visitor visit) const {
    index_.for_first_part(first_part, [&](const subscriber* x) { visit(*x); });
  }

  /// All of a host; null if there is none.
  [[nodiscard]] const records* of(peer_id host) const;

  /// Whom a tuple of ours is sent to, ascending: each once, however many of its subscriptions
  /// match. A deletion concerns those too who asked for a certain value.
  [[nodiscard]] std::vector<peer_id> hosts_for(const tuple& x) const;
  /// Is this host one of them?
  [[nodiscard]] bool wants(peer_id host, const tuple& x) const;
  /// Is there a subscription to this key?
  [[nodiscard]] bool covers(const key& name) const;

  /// Prototypes of a host without lifetime, in the order in which they came, within both limits.
  [[nodiscard]] std::vector<prototype> lasting_of(peer_id host, std::size_t count_max,
                                                  std::size_t octets_max) const;

  /// Who has subscribed to what, ascending by host, owner, key.
  [[nodiscard]] std::vector<std::pair<peer_id, prototype>> all() const;

  [[nodiscard]] std::size_t size() const { return index_.size(); }
  [[nodiscard]] std::size_t octets() const { return octets_.total(); }
  [[nodiscard]] std::uint64_t version() const {
    return version_;
  } ///< of each set of records another

private:
  struct host_records {
    std::map<std::string, subscriber, std::less<>> by_identity;
    records by_number;
  };

  std::size_t per_key_ = 0;
  fair_share count_;
  fair_share octets_;
  std::map<peer_id, host_records> hosts_; ///< none without records
  subscription_index<subscriber*> index_;
  std::uint64_t next_number_ = 0;
  std::uint64_t version_ = 0;
};

/// Octets that are equal for equal prototypes, and for no others.
[[nodiscard]] std::string identity_of(const prototype& x);

} // namespace rubicon::peis
