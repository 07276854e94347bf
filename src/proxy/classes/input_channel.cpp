#include "proxy/classes/input_channel.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::proxy {

namespace {

request_outcome to_outcome(input_outcome x) {
  switch (x) {
  case input_outcome::acknowledged:
    return request_outcome::acknowledged;
  case input_outcome::failed:
    return request_outcome::failed;
  case input_outcome::unreachable:
    return request_outcome::unreachable;
  case input_outcome::sent:
    return request_outcome::sent;
  case input_outcome::pending:
    break;
  }
  assert(false);
  return request_outcome::failed;
}

} // namespace

std::string_view to_string(request_outcome x) {
  switch (x) {
  case request_outcome::acknowledged:
    return "acknowledged";
  case request_outcome::failed:
    return "failed";
  case request_outcome::unreachable:
    return "unreachable";
  case request_outcome::refused:
    return "refused";
  case request_outcome::superseded:
    return "superseded";
  case request_outcome::timeout:
    return "timeout";
  case request_outcome::sent:
    return "sent";
  }
  return "unknown";
}

input_channel::outputs input_channel::add(request x, instant now) {
  outputs out;
  const auto older = std::find_if(waiting_.begin(), waiting_.end(),
                                  [&](const auto& w) { return w.input == x.input; });
  if (older != waiting_.end()) {
    out.emplace_back(finished{older->input, std::move(older->word), request_outcome::superseded,
                              now - older->asked});
    waiting_.erase(older);
  }
  x.asked = now;
  const bool replaces = current_ && current_->again && current_->what.input == x.input;
  waiting_.push_back(std::move(x));
  if (replaces)
    finish(request_outcome::superseded, now, out);
  else if (!current_)
    send_next(now, out);
  return out;
}

input_channel::outputs input_channel::on_status(const input_status& x, instant now) {
  outputs out;
  const bool fresh = note(x);
  if (!current_)
    return out;
  if (current_->again) { // a late answer to a write that was given up
    if (current_->sequence == x.sequence && x.outcome == input_outcome::acknowledged)
      finish(request_outcome::acknowledged, now, out);
    return out;
  }
  if (!current_->sequence && fresh)
    current_->sequence = x.sequence;
  if (current_->sequence == x.sequence && x.outcome != input_outcome::pending)
    conclude(to_outcome(x.outcome), now, out);
  return out;
}

input_channel::outputs input_channel::on_time(instant now) {
  outputs out;
  if (!current_ || now < *deadline())
    return out;
  if (!current_->again) {
    conclude(request_outcome::timeout, now, out);
    return out;
  }
  current_->again.reset();
  current_->sequence.reset();
  current_->expires = now + answer_timeout_;
  out.emplace_back(submit{current_->what.octets, true});
  return out;
}

input_channel::outputs input_channel::drop_waiting(instant now) {
  outputs out;
  for (auto& x : waiting_)
    out.emplace_back(
        finished{x.input, std::move(x.word), request_outcome::unreachable, now - x.asked});
  waiting_.clear();
  if (current_ && current_->again)
    finish(request_outcome::unreachable, now, out);
  return out;
}

input_channel::outputs input_channel::on_gateway_changed(instant now) {
  outputs out;
  if (current_)
    finish(request_outcome::failed, now, out);
  return out;
}

std::optional<instant> input_channel::deadline() const {
  if (!current_)
    return std::nullopt;
  return current_->again ? current_->again : std::optional(current_->expires);
}

/// Remembers the newest status. @returns whether its number may be that of an unnumbered request
bool input_channel::note(const input_status& x) {
  const bool pending = x.outcome == input_outcome::pending;
  if (!newest_) {
    newest_ = x;
    return pending;
  }
  const bool counts_anew =
      pending && (x.sequence < newest_->sequence ||
                  (x.sequence == newest_->sequence && newest_->outcome != input_outcome::pending));
  const bool fresh = x.sequence > newest_->sequence || counts_anew;
  if (fresh || x.sequence == newest_->sequence)
    newest_ = x;
  return fresh;
}

/// What was written last has ended so: the request too, unless it is written again.
void input_channel::conclude(request_outcome outcome, instant now, outputs& out) {
  const auto again = now + retry_pause;
  if (outcome == request_outcome::acknowledged || outcome == request_outcome::sent ||
      again > current_->first + retry_for_)
    finish(outcome, now, out);
  else
    current_->again = again;
}

void input_channel::finish(request_outcome outcome, instant now, outputs& out) {
  auto& x = current_->what;
  out.emplace_back(finished{x.input, std::move(x.word), outcome, now - x.asked});
  current_.reset();
  if (!waiting_.empty())
    send_next(now, out);
}

/// @pre !waiting_.empty()
void input_channel::send_next(instant now, outputs& out) {
  current_ = current_request{std::move(waiting_.front()), now + answer_timeout_, now};
  waiting_.erase(waiting_.begin());
  out.emplace_back(submit{current_->what.octets});
}

} // namespace rubicon::proxy
