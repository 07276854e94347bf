// Finds the subscriptions that a key concerns without looking at the others (TUP-20).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "peis/key.hpp"

namespace rubicon::peis {

/// Records under the key or pattern they ask for: exact keys in a hash table, patterns by their
/// number of parts (0 for those that match every key). Within each, in the order of insertion.
template <class Record>
class subscription_index {
public:
  void insert(const key& wanted, Record x) {
    bucket_of(wanted).push_back({wanted, std::move(x)});
    ++size_;
  }

  /// Removes the records under exactly this key or pattern that satisfy the predicate.
  template <class Predicate>
  std::size_t erase_if(const key& wanted, Predicate predicate) {
    auto& entries = bucket_of(wanted); // an empty bucket made here is removed below
    const auto erased = std::erase_if(
        entries, [&](const entry& x) { return x.wanted == wanted && predicate(x.record); });
    if (entries.empty() && !wanted.is_pattern())
      exact_.erase(wanted.folded());
    size_ -= erased;
    return erased;
  }

  /// Calls `visit` with each record stored under exactly this key or pattern.
  template <class Visitor>
  void for_equal(const key& wanted, Visitor visit) {
    visit_equal(*this, wanted, visit);
  }
  template <class Visitor>
  void for_equal(const key& wanted, Visitor visit) const {
    visit_equal(*this, wanted, visit);
  }

  /// Calls `visit(const Record&)` for each record whose key or pattern covers `name`.
  template <class Visitor>
  void for_matching(const key& name, Visitor visit) const {
    if (const auto at = exact_.find(name.folded()); at != exact_.end()) {
      for (const auto& x : at->second)
        visit(x.record);
    }
    for (const auto& entries : {&patterns_[name.parts()], &patterns_[0]}) {
      for (const auto& x : *entries) {
        if (x.wanted.matches(name))
          visit(x.record);
      }
    }
  }

  /// Removes all records that satisfy the predicate.
  template <class Predicate>
  void erase_everywhere(Predicate predicate) {
    const auto gone = [&](const entry& x) { return predicate(x.record); };
    for (auto at = exact_.begin(); at != exact_.end();) {
      size_ -= std::erase_if(at->second, gone);
      at = at->second.empty() ? exact_.erase(at) : std::next(at);
    }
    for (auto& entries : patterns_)
      size_ -= std::erase_if(entries, gone);
  }

  [[nodiscard]] std::size_t size() const { return size_; }

private:
  struct entry {
    key wanted;
    Record record;
  };
  using bucket = std::vector<entry>;

  template <class Self, class Visitor>
  static void visit_equal(Self& self, const key& wanted, Visitor& visit) {
    auto* entries = &self.patterns_[wanted.parts()];
    if (!wanted.is_pattern()) {
      const auto at = self.exact_.find(wanted.folded());
      if (at == self.exact_.end())
        return;
      entries = &at->second;
    }
    for (auto& x : *entries) {
      if (x.wanted == wanted)
        visit(x.record);
    }
  }

  bucket& bucket_of(const key& wanted) {
    return wanted.is_pattern() ? patterns_[wanted.parts()] : exact_[wanted.folded()];
  }

  std::unordered_map<std::string, bucket> exact_; ///< never walked in an order that shows
  std::array<bucket, key_parts_max + 1> patterns_;
  std::size_t size_ = 0;
};

} // namespace rubicon::peis
