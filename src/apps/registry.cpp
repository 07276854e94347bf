#include "apps/registry.hpp"

#include <utility>

namespace rubicon::apps {

void settings::set(const std::string& key, setting x) {
  values_[key] = std::move(x);
}

bool registry::add(application_kind x) {
  auto name = x.name;
  return kinds_.emplace(std::move(name), std::make_shared<const application_kind>(std::move(x)))
      .second;
}

} // namespace rubicon::apps
