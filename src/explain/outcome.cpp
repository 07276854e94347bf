#include "explain/outcome.hpp"

#include <algorithm>

#include "core/account/loss.hpp"
#include "peis/tuples/key.hpp"

namespace rubicon::explain {

namespace {

/// A message that nobody has carried for so long is lost, even if no loss was reported.
constexpr duration patience = 60s;

/// As people say it.
std::string words_of(const std::string& outcome) {
  if (outcome == "loss")
    return "lost on the radio link";
  if (outcome == "weak")
    return "too weak";
  if (outcome == "off")
    return "a radio was off";
  if (outcome == "captured")
    return "the receiver was receiving another frame";
  if (outcome == "half_duplex")
    return "the receiver was sending";
  if (outcome == "overflow")
    return "no receive buffer";
  if (outcome == "out_of_reach")
    return "out of range";
  if (outcome == "filtered")
    return "no mote there has this address";
  if (outcome == "nobody")
    return "received by no radio";
  if (outcome == "channel_access_failure")
    return "the channel was busy at every attempt";
  if (outcome == "no_ack")
    return "no acknowledgement";
  if (outcome == "queue_full")
    return "the radio's queue was full";
  if (outcome == "aborted")
    return "the radio was switched off";
  return outcome.empty() ? "not answered" : outcome;
}

retries retries_of(const traces& all, const message& x) {
  retries sum;
  for (const auto n : x.nodes) {
    const auto& hop = all.nodes[n];
    if (hop.what != step::hop)
      continue;
    if (hop.over == medium::air)
      sum.radio += repeats(hop);
    else if (hop.over == medium::serial || hop.over == medium::backbone)
      sum.serial += repeats(hop);
    else
      sum.peis += repeats(hop);
  }
  sum.transport = x.sends > 0 ? x.sends - 1 : 0;
  return sum;
}

/// The hop of the content, or else of the greeting, that was in flight last.
const node* last_hop_of(const traces& all, const message& x) {
  for (const auto of : {cargo::content, cargo::greeting, cargo::greeting_answer}) {
    const node* last = nullptr;
    for (const auto n : x.nodes) {
      const auto& hop = all.nodes[n];
      if (hop.what == step::hop && hop.of == of)
        last = &hop;
    }
    if (last != nullptr)
      return last;
  }
  return nullptr;
}

/// Whether nobody will try again.
bool is_given_up(const node* last) {
  if (last == nullptr || last->arrived)
    return false;
  if (last->over == medium::serial || last->over == medium::backbone)
    return !last->attempts.empty() && !last->attempts.back().outcome.empty();
  return !last->failure.empty();
}

/// Where the last hop that arrived did so, and nothing followed.
std::string stuck_at(const traces& all, const node& hop) {
  const auto place = hop.to.empty() ? names::of(hop.from) : names::of(hop.to);
  if (hop.over == medium::peis)
    return place + " received it but did not forward it: no route, or no receiver there";
  if (all.known.place_of(hop.to) != hop.to)
    return place +
           " received it but did not forward it: the receiver is not listed there, or it gave up";
  return place + " received it but did not forward it: a queue was full, or it has no route";
}

/// The cause in words, as part of a line.
std::string sentence_of(loss x) {
  std::string text(meaning_of(x));
  text.erase(text.find_last_not_of('.') + 1);
  if (!text.empty())
    text.front() = static_cast<char>(text.front() | 0x20);
  std::erase(text, '`');
  return text;
}

/// What ended a hop that did not arrive, however often it was tried.
std::string last_obstacle(const node& x) {
  if (x.over == medium::peis && !x.failure.empty()) {
    auto text = x.failure;
    std::ranges::replace(text, '_', ' ');
    return text;
  }
  if (x.attempts.empty())
    return x.failure.empty() ? "never sent" : words_of(x.failure);
  if (x.failure == "channel_access_failure" || x.failure == "aborted")
    return words_of(x.failure);
  const auto missed = std::find_if(x.attempts.rbegin(), x.attempts.rend(),
                                   [](const auto& each) { return !each.arrived; });
  return missed == x.attempts.rend() ? "not all fragments were sent" : words_of(missed->outcome);
}

} // namespace

std::string_view to_string(message_status x) {
  switch (x) {
  case message_status::delivered:
    return "delivered";
  case message_status::lost:
    return "lost";
  case message_status::refused:
    return "refused";
  case message_status::in_flight:
    return "in flight";
  }
  return "unknown";
}

std::uint32_t repeats(const node& x) {
  const auto all = static_cast<std::uint32_t>(x.attempts.size());
  return all > x.fragments ? all - x.fragments : 0;
}

std::string failures(const node& x) {
  std::vector<std::pair<std::string, unsigned>> runs;
  for (const auto& each : x.attempts) {
    if (each.arrived)
      continue;
    const auto outcome = words_of(each.outcome);
    if (!runs.empty() && runs.back().first == outcome)
      ++runs.back().second;
    else
      runs.emplace_back(outcome, 1);
  }
  std::string text;
  for (const auto& [outcome, times] : runs)
    text += (text.empty() ? "" : ", ") + (times > 1 ? std::to_string(times) + " × " : "") + outcome;
  return text;
}

std::string obstacle(const node& x) {
  if (x.arrived)
    return {};
  const auto tries = x.attempts.size();
  const auto what = failures(x);
  if (x.over == medium::peis && !x.failure.empty()) {
    auto text = what;
    for (const auto c : (what.empty() ? "" : ", then ") + x.failure)
      text += c == '_' ? ' ' : c;
    return text;
  }
  if (tries == 0)
    return x.failure.empty() ? "never sent" : words_of(x.failure);
  auto text = tries == 1 ? what : std::to_string(tries) + " tries: " + what;
  if (what.empty()) // all frames arrived, but not all fragments were sent
    return "not all fragments were sent";
  if (x.failure == "channel_access_failure" || x.failure == "aborted")
    text += ", then " + words_of(x.failure);
  return text;
}

std::string route_of(const node& x) {
  const auto from = names::of(x.from);
  if (x.to.empty())
    return from + " → all";
  const auto to = names::of(x.to);
  const auto slash = from.find('/');
  const bool same_island =
      slash != std::string::npos && to.compare(0, slash + 1, from, 0, slash + 1) == 0;
  return from + " → " + (same_island ? to.substr(slash + 1) : to);
}

namespace {

/// What is known of a message that the run does not account for, or has not ended.
message_status status_as_seen(const traces& all, const message& x, const node* last) {
  const auto quiet_since = last != nullptr ? last->time() : all.nodes[x.root].begin;
  const bool is_over =
      x.failed || all.end - quiet_since > patience || (!x.is_reliable && is_given_up(last));
  return is_over && !x.is_accounted ? message_status::lost : message_status::in_flight;
}

/// Where its last copy was, and why it got no further.
void explain_end(const traces& all, const message& x, const node* last, outcome& y) {
  if (last == nullptr) {
    y.why = "it never left the sender";
  } else if (last->of == cargo::greeting_answer && last->arrived) {
    y.why = "it never left the sender, though the receiver answered the greeting";
  } else if (x.turned_away) {
    y.why = all.known.of(x.destination) +
            " did not accept it: it was busy, or one of the two restarted";
  } else if (last->of == cargo::greeting && last->arrived &&
             all.known.address_of(last->to) == x.destination) {
    y.why = all.known.of(x.destination) + " did not answer the greeting";
  } else if (last->arrived) {
    y.why = stuck_at(all, *last);
  } else {
    y.where = route_of(*last);
    y.why = obstacle(*last);
    y.obstacle = last_obstacle(*last);
  }
}

} // namespace

outcome outcome_of(const traces& all, const message& x) {
  outcome y;
  y.retries = retries_of(all, x);
  const auto begun = all.nodes[x.root].begin;
  const auto delivered = x.ending && x.ending->arrived ? std::optional(x.ending->at)
                         : x.is_accounted              ? std::nullopt
                                                       : x.delivered;
  if (delivered) {
    y.status = message_status::delivered;
    y.took = *delivered - begun;
    return y;
  }
  if (x.refused) {
    y.status = message_status::refused;
    y.why = y.obstacle =
        "its mote did not accept it: it had joined no island, or its queue was full";
    return y;
  }
  const auto* last = last_hop_of(all, x);
  y.status = x.ending ? message_status::lost : status_as_seen(all, x, last);
  explain_end(all, x, last, y);
  if (x.ending)
    y.cause = x.ending->cause;
  if (x.ending && (last == nullptr || last->arrived)) { // the hops do not show it: the account does
    const auto cause = parse_loss(x.ending->cause);
    y.where = names::of(x.ending->place);
    y.obstacle.clear();
    y.why = cause ? sentence_of(*cause) : x.ending->cause;
  }
  if (y.obstacle.empty())
    y.obstacle = y.why;
  return y;
}

std::vector<audience> audience_of(const traces& all, const tuple_value& x) {
  std::vector<audience> out;
  const auto name = peis::key::from_wire(x.key);
  if (!name || !x.set)
    return out;
  for (const auto& watcher : all.watchers) {
    const auto pattern = peis::key::from_wire(watcher.pattern);
    const bool wants = pattern && watcher.since <= *x.set && pattern->matches(*name) &&
                       (watcher.owner < 0 || watcher.owner == x.owner.value);
    const auto who = names::of(watcher.who);
    if (!wants || std::ranges::find(out, who, &audience::who) != out.end())
      continue;
    audience one{who, {}};
    for (const auto n : x.nodes) {
      const auto& y = all.nodes[n];
      if (y.what == step::notified && y.from == watcher.who && !one.after)
        one.after = y.time() - *x.set;
    }
    const auto last = all.last_notified.find(watcher.who);
    if (one.after || (last != all.last_notified.end() && last->second > *x.set))
      out.push_back(std::move(one));
  }
  return out;
}

} // namespace rubicon::explain
