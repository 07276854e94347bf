// What the owner of a kernel reads of the tuples that are here: own ones, and copies of others'.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"
#include "peis/kernel/kernel_layers.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/tuples/tuple_result_set.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Sends nothing (TUP-14). Names in brackets are those of D1.1 3.1.3.
class tuple_reader {
public:
  /// @param layers outlive this
  explicit tuple_reader(kernel_layers& layers) : layers_(layers) {}

  /// [getTuple] The tuple of that owner and full key, own or held because of a subscription, unless
  /// it has expired; it counts as read then (TUP-12). Abstract: owner or key is a wildcard.
  [[nodiscard]] reading get(peer_id owner, std::string_view key, read_mode mode, instant now);
  /// [getTupleByAbstract] Nothing also if the other fields of the prototype do not match.
  [[nodiscard]] reading get(const prototype& wanted, read_mode mode, instant now);

  /// [getTuples, getTuplesByAbstract] Appends all that match, ascending by key, then owner; each
  /// counts as read then (TUP-13).
  void get_all(const prototype& wanted, result_set& into, instant now,
               read_mode mode = read_mode::keep_old);

  /// As get(), without the marks of reading; null if there is none. kernel.* tuples that are not
  /// watched may be older than their period.
  [[nodiscard]] tuple_pointer find(peer_id owner, std::string_view key) const;

  /// All tuples held that match, ascending by key, then owner; any_peer matches every owner.
  [[nodiscard]] std::vector<tuple_pointer> find_all(peer_id owner, std::string_view pattern) const;

  /// Own tuples, ascending by key without letter case.
  [[nodiscard]] std::vector<tuple_pointer> own() const;

  /// Does anyone subscribe to our tuple of this key (TUP-23)? Local subscriptions count too.
  [[nodiscard]] bool has_subscriber(std::string_view key) const;

  /// Does the present value of an own tuple still wait for room on its way to a subscriber? If
  /// another is set now, that one never gets this: a writer that wants all to arrive waits.
  [[nodiscard]] bool is_waiting(std::string_view key) const;

  /// Keys and patterns, in lower case, by which peers subscribe to our tuples and whose first part
  /// is this one; catch-all patterns name nothing. @param first_part in lower case
  [[nodiscard]] std::set<std::string> subscribed(std::string_view first_part) const {
    return layers_.tuples.audience().subscribed(first_part);
  }
  /// Changes whenever subscribed() may.
  [[nodiscard]] std::uint64_t subscribers_version() const {
    return layers_.tuples.audience().version();
  }

  /// Time as tuples carry it: the ecology's time plus p2p_config::clock_offset.
  [[nodiscard]] timestamp network_time(instant now) const {
    return layers_.tuples.drafts().clock().network_time(now);
  }

private:
  kernel_layers& layers_;
};

} // namespace rubicon::peis
