// A list that its copies share until one of them changes it: ten thousand motes of one group have
// one list of programs.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

namespace rubicon {

/// Reads as a vector; to change it, edit() it. Different copies may be used by different threads.
template <class T>
class shared_list {
public:
  using value_type = T;
  using const_iterator = typename std::vector<T>::const_iterator;

  shared_list() = default;
  shared_list(std::vector<T> all) { edit() = std::move(all); }
  shared_list(std::initializer_list<T> all) : shared_list(std::vector<T>(all)) {}

  operator const std::vector<T>&() const { return all(); }
  [[nodiscard]] const std::vector<T>& all() const {
    static const std::vector<T> none;
    return all_ ? *all_ : none;
  }
  [[nodiscard]] const_iterator begin() const { return all().begin(); }
  [[nodiscard]] const_iterator end() const { return all().end(); }
  [[nodiscard]] std::size_t size() const { return all().size(); }
  [[nodiscard]] bool empty() const { return all().empty(); }
  [[nodiscard]] const T& operator[](std::size_t i) const { return all()[i]; }
  [[nodiscard]] const T& at(std::size_t i) const { return all().at(i); }

  /// Its own elements from now on, until it is copied.
  [[nodiscard]] std::vector<T>& edit() {
    if (!all_ || all_.use_count() > 1)
      all_ = std::make_shared<std::vector<T>>(all());
    return *all_;
  }

  friend bool operator==(const shared_list& a, const shared_list& b) {
    return a.all_ == b.all_ || a.all() == b.all();
  }

private:
  std::shared_ptr<std::vector<T>> all_; ///< nullptr: none
};

} // namespace rubicon
