// Tuples held, own and others', by owner and key, and when each vanishes (TUP-01, TUP-15, TUP-20).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/time.hpp"
#include "peis/tuple.hpp"

namespace rubicon::peis {

/// Ordered, so that every walk over it is the same on every machine. A walk for an owner looks at
/// no other owner's tuples, one for a pattern at no tuple that differs before the first wildcard.
class tuple_store {
public:
  struct entry {
    tuple_pointer content;
    std::optional<instant> expiry;
    mutable bool is_new = true; ///< not read since it was stored (TUP-12)
  };

  [[nodiscard]] const entry* find(peer_id owner, const key& name) const;

  /// Stores or replaces as something new; the letter case of a known key stays.
  /// @returns the tuple stored
  tuple_pointer put(tuple x, std::optional<instant> expiry);

  /// Takes a tuple out; null if there is none.
  tuple_pointer remove(peer_id owner, const key& name);

  /// Takes out the next tuple whose time has come; to be called until it returns null.
  tuple_pointer take_expired(instant now);

  /// Calls `visit(const entry&)` for what matches, ascending by key, then owner.
  template <class Visitor>
  void for_matching(const prototype& wanted, Visitor visit) const {
    for (const auto* x : candidates(wanted.owner, wanted.name)) {
      if (wanted.matches(*x->content))
        visit(*x);
    }
  }

  /// Matches ascending by key, then owner.
  [[nodiscard]] std::vector<tuple_pointer> find_all(const prototype& wanted) const;

  [[nodiscard]] std::optional<instant> deadline() const;
  [[nodiscard]] std::size_t size() const { return size_; }

private:
  using tuples_of_owner = std::map<std::string, entry, std::less<>>;

  [[nodiscard]] std::vector<const entry*> candidates(peer_id owner, const key& pattern) const;
  void remember(const entry& x);
  void forget(const entry& x);

  std::map<peer_id, tuples_of_owner> owners_; ///< by folded key; no owner without tuples
  std::map<std::string, std::set<peer_id>, std::less<>> keys_; ///< whose tuples have this key
  std::set<std::tuple<instant, peer_id, std::string>> expiries_;
  std::size_t size_ = 0;
};

} // namespace rubicon::peis
