#include "core/provenance.hpp"

#include <utility>

namespace rubicon {

namespace {

/// Of one thread. To hand it down by argument would put a parameter that no protocol reads into
/// most functions of all cores.
struct context {
  provenance_source* who = nullptr;
  bool is_set = false; ///< by acting_on
  std::uint64_t number = 0;
};

thread_local context here; // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

} // namespace

std::uint64_t provenance::now() {
  if (here.is_set)
    return here.number;
  return here.who == nullptr ? 0 : here.who->handled_number();
}

provenance provenance::begin(std::string_view what, std::uint64_t id) {
  return provenance(here.who == nullptr ? 0 : here.who->begin(what, id));
}

acting_on::acting_on(provenance x)
    : was_set_(std::exchange(here.is_set, true)), before_(std::exchange(here.number, x.number())) {}

acting_on::~acting_on() {
  here.is_set = was_set_;
  here.number = before_;
}

turn_of::turn_of(provenance_source* who) : before_(std::exchange(here.who, who)) {}

turn_of::~turn_of() {
  here.who = before_;
}

} // namespace rubicon
