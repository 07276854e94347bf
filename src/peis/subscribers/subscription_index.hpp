// Finds the subscriptions that a key concerns without looking at the others (TUP-20).
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "peis/tuples/key.hpp"

namespace rubicon::peis {

/// Records under the key or pattern they ask for, in a tree with one level for each part: a key
/// goes two ways at each level, that of its part and that of the wildcard, so what it finds costs
/// at most 2^7 leaves, however many records there are and whatever their keys. Within a leaf, in
/// the order of insertion. Trees are ordered: no peer can choose keys that collide.
template <class Record>
class subscription_index {
public:
  subscription_index() = default;
  subscription_index(subscription_index&&) noexcept = default;
  subscription_index& operator=(subscription_index&&) noexcept = default;

  void insert(const key& wanted, Record x) {
    auto* at = &root_;
    for (auto rest = wanted.any() ? nothing : std::optional(std::string_view(wanted.folded()));
         rest;) {
      auto& child = at->children[std::string(next_part(rest))];
      if (!child)
        child = std::make_unique<node>();
      at = child.get();
    }
    at->records.push_back(std::move(x));
    ++size_;
  }

  /// Removes the records under exactly this key or pattern that satisfy the predicate.
  template <class Predicate>
  std::size_t erase_if(const key& wanted, Predicate predicate) {
    const auto rest = wanted.any() ? nothing : std::optional(std::string_view(wanted.folded()));
    const auto erased = erase_below(root_, rest, predicate);
    size_ -= erased;
    return erased;
  }

  /// Calls `visit` with each record stored under exactly this key or pattern.
  template <class Visitor>
  void for_equal(const key& wanted, Visitor visit) const {
    if (const auto* at = leaf(wanted)) {
      for (const auto& x : at->records)
        visit(x);
    }
  }

  /// Calls `visit(const Record&)` for each record whose key or pattern covers `name`.
  template <class Visitor>
  void for_matching(const key& name, Visitor visit) const {
    for (const auto& x : root_.records) // under the empty key, which covers all
      visit(x);
    if (!name.any())
      visit_matching(root_, std::string_view(name.folded()), visit);
  }

  /// Calls `visit(const Record&)` with each record, ascending by the parts of their keys.
  template <class Visitor>
  void for_all(Visitor visit) const {
    visit_all(root_, visit);
  }

  /// The same for those whose first part is this one. @param first_part in lower case
  template <class Visitor>
  void for_first_part(std::string_view first_part, Visitor visit) const {
    if (const auto at = root_.children.find(first_part); at != root_.children.end())
      visit_all(*at->second, visit);
  }

  [[nodiscard]] std::size_t size() const { return size_; }

private:
  struct node {
    std::map<std::string, std::unique_ptr<node>, std::less<>> children; ///< `*` is the wildcard
    std::vector<Record> records;

    [[nodiscard]] bool empty() const { return children.empty() && records.empty(); }
  };
  /// What is left of a key; nothing behind its last part.
  using remainder = std::optional<std::string_view>;
  static constexpr remainder nothing = std::nullopt;

  /// Takes the first part off. @pre there is one
  static std::string_view next_part(remainder& rest) {
    const auto dot = rest->find('.');
    const auto part = rest->substr(0, dot);
    if (dot == std::string_view::npos)
      rest.reset();
    else
      rest->remove_prefix(dot + 1);
    return part;
  }

  [[nodiscard]] const node* leaf(const key& wanted) const {
    const auto* at = &root_;
    auto rest = wanted.any() ? nothing : remainder(wanted.folded());
    while (rest) {
      const auto child = at->children.find(next_part(rest));
      if (child == at->children.end())
        return nullptr;
      at = child->second.get();
    }
    return at;
  }

  template <class Predicate>
  static std::size_t erase_below(node& at, remainder rest, Predicate& predicate) {
    if (!rest)
      return std::erase_if(at.records, predicate);
    const auto child = at.children.find(next_part(rest));
    if (child == at.children.end())
      return 0;
    const auto erased = erase_below(*child->second, rest, predicate);
    if (child->second->empty())
      at.children.erase(child);
    return erased;
  }

  template <class Visitor>
  static void visit_matching(const node& at, remainder rest, Visitor& visit) {
    if (!rest) {
      for (const auto& x : at.records)
        visit(x);
      return;
    }
    const auto part = next_part(rest);
    for (const auto way : {part, std::string_view("*")}) {
      if (const auto child = at.children.find(way); child != at.children.end())
        visit_matching(*child->second, rest, visit);
      if (part == "*") // of a pattern that is looked up itself
        return;
    }
  }

  template <class Visitor>
  static void visit_all(const node& at, Visitor& visit) {
    for (const auto& x : at.records)
      visit(x);
    for (const auto& [part, child] : at.children)
      visit_all(*child, visit);
  }

  node root_;
  std::size_t size_ = 0;
};

} // namespace rubicon::peis
