#include "peis/link/stranger_table.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr duration first_wait = 1s; // for an answer

} // namespace

void stranger_table::note(peer_id host, bool misled, instant now) {
  const auto [at, is_new] = strangers_.try_emplace(host, stranger{0, misled, now});
  if (is_new)
    questions_.emplace(now, host);
}

void stranger_table::forget(peer_id host) {
  const auto at = strangers_.find(host);
  if (at == strangers_.end())
    return;
  questions_.erase({at->second.next, host});
  strangers_.erase(at);
}

void stranger_table::mislead(peer_id host, instant now) {
  const auto at = strangers_.find(host);
  if (at != strangers_.end() && !std::exchange(at->second.misled, true))
    schedule(*at, now);
}

void stranger_table::schedule(entry& x, instant at) {
  questions_.erase({x.second.next, x.first});
  x.second.next = at;
  questions_.emplace(at, x.first);
}

std::optional<std::pair<instant, peer_id>> stranger_table::next() const {
  return questions_.empty() ? std::nullopt : std::optional(*questions_.begin());
}

stranger_table::question stranger_table::ask(peer_id host, instant now) {
  auto& x = *strangers_.find(host);
  const question asked{host, x.second.questions, x.second.misled};
  const duration wait = first_wait * (1U << std::min(x.second.questions++, 8U));
  schedule(x, now + std::min(wait, longest_pause_));
  return asked;
}

} // namespace rubicon::peis
