// Tuples held, own and others', by key and owner, and when each vanishes (TUP-01, TUP-15).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "peis/tuple.hpp"

namespace rubicon::peis {

/// Ordered, so that every walk over it is the same on every machine.
class tuple_store {
public:
  [[nodiscard]] const tuple* find(const key& name, peer_id owner) const;

  /// Stores or replaces; the letter case of a known key stays. @returns the tuple stored
  const tuple& put(tuple x, std::optional<instant> expiry);

  /// Takes a tuple out.
  std::optional<tuple> remove(const key& name, peer_id owner);

  /// Takes out the next tuple whose time has come; to be called until it returns nothing.
  std::optional<tuple> take_expired(instant now);

  /// Matches ascending by key, then owner.
  [[nodiscard]] std::vector<const tuple*> find_all(peer_id owner, const key& pattern) const;

  [[nodiscard]] std::optional<instant> deadline() const;
  [[nodiscard]] std::size_t size() const { return size_; }

private:
  struct entry {
    tuple content;
    std::optional<instant> expiry;
  };
  using owners = std::map<peer_id, entry>;

  tuple take(std::map<std::string, owners>::iterator at, owners::iterator which);

  std::map<std::string, owners> tuples_; ///< by folded key
  std::set<std::tuple<instant, std::string, peer_id>> expiries_;
  std::size_t size_ = 0;
};

} // namespace rubicon::peis
