#include "peis/tuples/quit_requests.hpp"

#include <iterator>

#include "peis/tuples/key.hpp"

namespace rubicon::peis {

namespace {

/// An init lets its components end first.
constexpr duration quit_patience = 6s;

} // namespace

/// Any value but these asks to quit.
bool asks_to_quit(const tuple& x) {
  const auto text = key::from_wire(x.text().substr(0, key_characters_max));
  return text && !text->folded().empty() && text->folded() != "no" && text->folded() != "nil";
}

void quit_requests::expect(request_id request, peer_id owner) {
  pending_[request] = {owner, std::nullopt};
}

bool quit_requests::on_delivered(request_id request, instant now) {
  const auto at = pending_.find(request);
  if (at == pending_.end())
    return false;
  at->second.until = now + quit_patience;
  return true;
}

void quit_requests::on_undelivered(request_id request) {
  pending_.erase(request);
}

template <class Condition>
std::vector<request_id> quit_requests::take_if(Condition ended) {
  std::vector<request_id> taken;
  for (auto at = pending_.begin(); at != pending_.end();) {
    const bool takes = at->second.until && ended(at->second);
    if (takes)
      taken.push_back(at->first);
    at = takes ? pending_.erase(at) : std::next(at);
  }
  return taken;
}

std::vector<request_id> quit_requests::take_succeeded(peer_id vanished) {
  return take_if([&](const pending& x) { return x.owner == vanished; });
}

std::vector<request_id> quit_requests::take_refused(instant now) {
  return take_if([&](const pending& x) { return *x.until <= now; });
}

std::optional<instant> quit_requests::deadline() const {
  std::optional<instant> due;
  for (const auto& [request, x] : pending_)
    due = earliest(due, x.until);
  return due;
}

} // namespace rubicon::peis
