// A map for a few elements: a sorted vector, which takes half the memory of a tree while it is
// empty, and none for nodes. C++20 has no such map, and Boost's has no extract().
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace rubicon {

/// As std::map, ascending by key, but what is inserted or erased moves the elements behind it, and
/// invalidates references to them.
template <class Key, class Value>
class small_map {
public:
  using key_type = Key;
  using value_type = std::pair<Key, Value>;
  using iterator = typename std::vector<value_type>::iterator;
  using const_iterator = typename std::vector<value_type>::const_iterator;

  [[nodiscard]] iterator begin() { return all_.begin(); }
  [[nodiscard]] iterator end() { return all_.end(); }
  [[nodiscard]] const_iterator begin() const { return all_.begin(); }
  [[nodiscard]] const_iterator end() const { return all_.end(); }
  [[nodiscard]] std::size_t size() const { return all_.size(); }
  [[nodiscard]] bool empty() const { return all_.empty(); }

  template <class K>
  [[nodiscard]] iterator find(const K& x) {
    const auto at = place_of(all_, x);
    return is_at(at, x) ? at : all_.end();
  }
  template <class K>
  [[nodiscard]] const_iterator find(const K& x) const {
    const auto at = place_of(all_, x);
    return is_at(at, x) ? at : all_.end();
  }
  template <class K>
  [[nodiscard]] bool contains(const K& x) const {
    return find(x) != end();
  }

  /// @throws std::out_of_range
  [[nodiscard]] const Value& at(const Key& x) const {
    const auto found = find(x);
    if (found == end())
      throw std::out_of_range("small_map::at");
    return found->second;
  }

  Value& operator[](const Key& x) {
    const auto at = place_of(all_, x);
    if (is_at(at, x))
      return at->second;
    return all_.emplace(at, x, Value{})->second;
  }

  /// @returns whether there was none with this key; else nothing changes
  template <class... Args>
  bool emplace(const Key& x, Args&&... args) {
    const auto at = place_of(all_, x);
    if (is_at(at, x))
      return false;
    all_.emplace(at, x, Value(std::forward<Args>(args)...));
    return true;
  }

  iterator erase(const_iterator x) { return all_.erase(x); }
  void erase(const Key& x) { static_cast<void>(extract(x)); }

  /// Takes an element out. @returns its value; nothing: there is none
  std::optional<Value> extract(const Key& x) {
    const auto at = find(x);
    if (at == end())
      return std::nullopt;
    std::optional<Value> taken(std::move(at->second));
    all_.erase(at);
    return taken;
  }

  template <class Predicate>
  void erase_if(Predicate is_unwanted) {
    std::erase_if(all_, is_unwanted);
  }

  friend bool operator==(const small_map&, const small_map&) = default;

private:
  template <class All, class K>
  static auto place_of(All& all, const K& x) {
    return std::lower_bound(all.begin(), all.end(), x,
                            [](const value_type& a, const K& b) { return a.first < b; });
  }
  template <class K>
  [[nodiscard]] bool is_at(const_iterator place, const K& x) const {
    return place != all_.end() && !(x < place->first);
  }

  std::vector<value_type> all_;
};

} // namespace rubicon
