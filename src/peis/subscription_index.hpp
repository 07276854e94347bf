// Finds the subscriptions that a key concerns without looking at the others (TUP-20).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "peis/key.hpp"

namespace rubicon::peis {

/// Records under the key or pattern they ask for: exact keys in a hash table, patterns by their
/// number of parts (0 for those that match every key) and, in another table, by their first part
/// unless that is a wildcard. Within each, in the order of insertion.
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
    else if (entries.empty() && !wanted.literal_prefix().empty())
      prefixed_.erase(prefix_of(wanted));
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
    const auto visit_matches = [&](const bucket& entries) {
      for (const auto& x : entries) {
        if (x.wanted.matches(name))
          visit(x.record);
      }
    };
    if (!prefixed_.empty()) {
      if (const auto at = prefixed_.find(prefix_of(name)); at != prefixed_.end())
        visit_matches(at->second);
    }
    visit_matches(patterns_[name.parts()]);
    visit_matches(patterns_[0]);
  }

  /// Calls `visit(const Record&)` with each record, in no order to rely on.
  template <class Visitor>
  void for_all(Visitor visit) const {
    for (const auto* table : {&exact_, &prefixed_}) {
      for (const auto& [name, entries] : *table) {
        for (const auto& x : entries)
          visit(x.record);
      }
    }
    for (const auto& entries : patterns_) {
      for (const auto& x : entries)
        visit(x.record);
    }
  }

  /// Removes all records that satisfy the predicate. @returns how many
  template <class Predicate>
  std::size_t erase_everywhere(Predicate predicate) {
    const auto before = size_;
    const auto gone = [&](const entry& x) { return predicate(x.record); };
    for (auto* table : {&exact_, &prefixed_}) {
      for (auto at = table->begin(); at != table->end();) {
        size_ -= std::erase_if(at->second, gone);
        at = at->second.empty() ? table->erase(at) : std::next(at);
      }
    }
    for (auto& entries : patterns_)
      size_ -= std::erase_if(entries, gone);
    return before - size_;
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
    if (!wanted.literal_prefix().empty()) {
      auto& table = wanted.is_pattern() ? self.prefixed_ : self.exact_;
      const auto at = table.find(wanted.is_pattern() ? prefix_of(wanted) : wanted.folded());
      if (at == table.end())
        return;
      entries = &at->second;
    }
    for (auto& x : *entries) {
      if (x.wanted == wanted)
        visit(x.record);
    }
  }

  /// First part and number of parts. @pre the first part is not a wildcard
  static std::string prefix_of(const key& x) {
    const auto first = std::string_view(x.folded()).substr(0, x.folded().find('.'));
    return static_cast<char>('0' + x.parts()) + std::string(first);
  }

  bucket& bucket_of(const key& wanted) {
    if (!wanted.is_pattern())
      return exact_[wanted.folded()];
    return wanted.literal_prefix().empty() ? patterns_[wanted.parts()]
                                           : prefixed_[prefix_of(wanted)];
  }

  // The tables are never walked in an order that shows.
  std::unordered_map<std::string, bucket> exact_;
  std::unordered_map<std::string, bucket> prefixed_;
  std::array<bucket, key_parts_max + 1> patterns_;
  std::size_t size_ = 0;
};

} // namespace rubicon::peis
