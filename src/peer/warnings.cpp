#include "peer/warnings.hpp"

namespace rubicon::peer {

void warnings::give(const std::string& text) const {
  if (to_)
    to_(text);
}

void warnings::give(kind which, const std::string& text, instant now) {
  auto& last = last_.at(static_cast<std::size_t>(which));
  if (last && now - *last < gap)
    return;
  last = now;
  give(text);
}

} // namespace rubicon::peer
