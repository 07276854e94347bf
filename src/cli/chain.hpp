// One more listener for what has room for one.
#pragma once

#include <functional>
#include <utility>

namespace rubicon::cli {

/// From now on `next` is called after what there was.
template <class... Arguments, class F>
void also(std::function<void(Arguments...)>& all, F next) {
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
