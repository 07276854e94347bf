// Callbacks one after the other.
#pragma once

#include <functional>
#include <utility>

namespace rubicon::cli {

/// From now on `next` is called after the former callback.
template <class... Arguments, class F>
void chain(std::function<void(Arguments...)>& all, F next) {
  if (!all) {
    all = std::move(next);
    return;
  }
  all = [first = std::move(all), next = std::move(next)](Arguments... x) mutable {
    first(x...);
    next(x...);
  };
}

} // namespace rubicon::cli
