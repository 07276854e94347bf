// Tuples held, own and others', by owner and key, and when each vanishes (TUP-01, TUP-15, TUP-20).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "peis/link/fair_share.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::peis {

/// Ordered, so that every walk over it is the same on every machine. A walk for an owner looks at
/// no other owner's tuples, one for a pattern at no tuple that differs before the first wildcard.
class tuple_store {
public:
  /// Who has put a tuple here, and so whose share of which memory it takes.
  enum class origin : std::uint8_t {
    ours,    ///< own, set here: no limit but that of their number
    written, ///< own, set or appended to by another host
    held,    ///< a copy of its owner's
  };
  struct source {
    origin from = origin::ours;
    peer_id host; ///< the writer or owner; of ours: none

    friend bool operator==(const source&, const source&) = default;
  };
  /// Octets that tuples of others may take with all that surrounds them.
  struct limits {
    std::size_t written = 0;
    std::size_t held = 0;
    std::shared_ptr<fair_share> pool = nullptr; ///< of both, and other tables
  };

  struct entry {
    tuple_pointer content;
    instant expiry = instant::max(); ///< max: none
    source by = {};
    std::uint32_t weight = 0;
    bool created_by_other = false;
    mutable bool is_new = true; ///< not read since it was stored (TUP-12)
  };

  tuple_store() = default;
  explicit tuple_store(const limits& x) : written_(x.written, x.pool), held_(x.held, x.pool) {}

  [[nodiscard]] const entry* find(peer_id owner, const key& name) const; ///< null if none
  [[nodiscard]] tuple_pointer content(peer_id owner, const key& name) const {
    const auto* x = find(owner, name);
    return x != nullptr ? x->content : nullptr;
  }

  /// Is there room for a tuple of this content, in the place of the one of its name?
  [[nodiscard]] bool admits(const tuple& x, source by) const;

  /// Stores or replaces as something new; the letter case of a known key stays.
  /// @returns the tuple stored
  tuple_pointer put(tuple x, std::optional<instant> expiry, source by);

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

  /// Calls `visit(const tuple_pointer&, bool is_new)` for each match that has not expired,
  /// ascending by key, then owner, and marks those as read for which it returns true (TUP-12).
  template <class Visitor>
  void read(const prototype& wanted, instant now, Visitor visit) const {
    for_matching(wanted, [&](const entry& x) {
      if (x.expiry > now && visit(x.content, x.is_new))
        x.is_new = false;
    });
  }

  /// Goes through the tuples of one owner that may match, in pieces: begins behind the folded key
  /// `after` (at the first if it is empty), and keeps there how far it has come. `visit(const
  /// entry&)` returns false to come back to this one another time. It may put tuples in the place
  /// of others, but not remove any.
  /// @returns whether there are no more
  template <class Visitor>
  bool walk_on(peer_id owner, const key& pattern, std::string& after, Visitor visit) const {
    const auto of_owner = owners_.find(owner);
    if (of_owner == owners_.end())
      return true;
    const auto prefix = pattern.literal_prefix();
    const auto& all = of_owner->second;
    auto at = after.empty() ? all.lower_bound(prefix) : all.upper_bound(std::string_view(after));
    for (; at != all.end() && at->first.folded().starts_with(prefix); ++at) {
      if (!visit(at->second))
        return false;
      after = at->first.folded();
      if (!pattern.is_pattern())
        break;
    }
    return true;
  }

  /// Matches ascending by key, then owner.
  [[nodiscard]] std::vector<tuple_pointer> find_all(const prototype& wanted) const;

  [[nodiscard]] std::optional<instant> deadline() const;
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const fair_share& written() const { return written_; } ///< octets, by writer
  [[nodiscard]] const fair_share& held() const { return held_; }       ///< octets, by owner

private:
  using tuples_of_owner = std::map<key, entry, key_order>;
  using owned_key = std::pair<key, peer_id>;

  struct owned_key_order {
    using is_transparent = void;

    bool operator()(const owned_key& a, const owned_key& b) const {
      const auto names = a.first.folded().compare(b.first.folded());
      return names != 0 ? names < 0 : a.second < b.second;
    }
    bool operator()(const owned_key& a, std::string_view b) const { return a.first.folded() < b; }
    bool operator()(std::string_view a, const owned_key& b) const { return a < b.first.folded(); }
  };

  [[nodiscard]] std::vector<const entry*> candidates(peer_id owner, const key& pattern) const;
  void remember(const entry& x);
  void forget(const entry& x);
  [[nodiscard]] fair_share* share_of(origin x);

  std::map<peer_id, tuples_of_owner> owners_;                    ///< no owner without tuples
  std::set<owned_key, owned_key_order> all_keys_;                ///< of all owners
  std::set<std::tuple<instant, peer_id, std::string>> expiries_; ///< by folded key
  std::size_t size_ = 0;
  fair_share written_;
  fair_share held_;
};

/// Octets that a tuple takes with its key, its places in the trees and what the allocator adds.
[[nodiscard]] std::size_t weight_of(const tuple& x);

} // namespace rubicon::peis
