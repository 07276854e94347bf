#include "core/account/message_ledger.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <numeric>
#include <tuple>

#include "core/tuples/hand_over.hpp"

namespace rubicon {

std::string_view to_string(message_kind x) {
  constexpr std::array<std::string_view, 3> names{"message", "channel", "tunnel"};
  return names.at(static_cast<std::size_t>(x));
}

std::uint64_t message_tally::lost_in_all() const {
  return std::accumulate(lost.begin(), lost.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& x) { return sum + x.second; });
}

namespace {

bool gives_accounts = true; // NOLINT: set between runs only

} // namespace

void message_ledger::give_accounts(bool x) {
  gives_accounts = x;
}

std::shared_ptr<message_ledger> message_ledger::make() {
  return std::shared_ptr<message_ledger>(new message_ledger());
}

namespace {

std::string_view place_here() {
  const auto* who = provenance_here.who;
  return who == nullptr ? std::string_view() : who->place();
}

instant time_here() {
  const auto* who = provenance_here.who;
  return who == nullptr ? instant{} : who->time();
}

message_account* account_of(const account_ref& x) {
  return static_cast<message_account*>(x.get());
}

} // namespace

/// Most runs have one thread: what no other can see needs no lock.
std::unique_lock<std::mutex> message_ledger::locked() const {
  std::unique_lock lock(mutex_, std::defer_lock);
  if (account_ref::is_shared_between_threads())
    lock.lock();
  return lock;
}

const std::string& message_ledger::path(const std::string& x) {
  const auto lock = locked();
  return *paths_.insert(x).first;
}

account_ref message_ledger::open(std::uint64_t number, message_kind kind, mote_address source,
                                 mote_address destination) {
  message_end about;
  about.number = number;
  about.kind = kind;
  about.source = source;
  about.destination = destination;
  const auto lock = locked();
  auto& tally = tallies_[{source, kind}];
  ++tally.sent;
  return account_ref(new message_account(shared_from_this(), tally, about));
}

void message_ledger::cancel(message_account& x) {
  const auto lock = locked();
  x.cancel();
}

void message_ledger::note_loss(message_account& x, loss why) {
  const auto lock = locked();
  x.note_loss({why, time_here(), place_here()});
}

void message_ledger::note_arrival(message_account& x) {
  {
    const auto lock = locked();
    if (finished_ || !x.note_arrival(place_here(), time_here()))
      return;
  }
  notify(x.about());
}

void message_ledger::note_foreign_arrival(mote_address source, message_kind kind) {
  const auto lock = locked();
  ++foreign_[{source, kind}];
}

void message_ledger::finish() {
  {
    packages left; // destroyed unlocked: it is handed over
    const auto lock = locked();
    for (auto x = packages_.begin(); x != packages_.end();)
      if (const auto each = x++; account_of(each->account)->leaves()) {
        account_of(each->account)->note_loss(each->if_lost);
        remove(each, left);
      }
  }
  const auto lock = locked();
  finished_ = true;
}

void message_ledger::notify(const message_end& x) {
  if (observer_)
    observer_(x);
}

void message_ledger::end(message_account& x) {
  {
    const auto lock = locked();
    if (finished_ || !x.is_open())
      return;
    x.end(place_here(), time_here(), provenance_here.stops);
    const auto& about = x.about();
    if (about.outcome == message_end::how::lost) {
      const auto known = places_.size() < places_max;
      ++places_[{about.kind, about.cause, known ? about.place : std::string_view()}];
    } else if (about.outcome == message_end::how::handed_over) {
      note_handed_over(about);
    }
  }
  notify(x.about());
}

/// The newest note says when it departed: that it will not be seen again is known later.
void message_ledger::note_handed_over(const message_end& x) {
  const auto at = x.at > instant{} ? x.at : time_here();
  handed_.emplace_back(at, sender{x.source, x.kind});
  while (handed_.size() > lately_max || at - handed_.front().first > way_elsewhere)
    handed_.pop_front();
}

// Packages of PEIS links.

void message_ledger::depart(std::uint64_t name, bool leaves) {
  auto* const what = provenance_here.account;
  if (what == nullptr)
    return;
  package x{name, account_ref(what), {loss::package_lost, time_here(), place_here()}};
  packages over; // destroyed unlocked
  const auto lock = locked();
  expire(x.if_lost.at, over);
  remove(name, over);
  account_of(x.account)->set_leaves(leaves);
  by_name_[name] = packages_.insert(packages_.end(), std::move(x));
}

account_ref message_ledger::come(std::uint64_t name) {
  packages over;
  const auto lock = locked();
  remove(name, over);
  if (over.empty())
    return {};
  auto what = std::move(over.front().account);
  account_of(what)->set_leaves(false);
  return what;
}

void message_ledger::package_lost(std::uint64_t name) {
  packages over;
  const auto lock = locked();
  remove(name, over);
  for (const auto& x : over)
    account_of(x.account)->note_loss(x.if_lost);
}

void message_ledger::remove(packages::iterator which, packages& to) {
  by_name_.erase(which->name);
  to.splice(to.end(), packages_, which);
}

void message_ledger::remove(std::uint64_t name, packages& to) {
  if (const auto found = by_name_.find(name); found != by_name_.end())
    remove(found->second, to);
}

/// Who hands a package to another process sees it come back soon or never.
void message_ledger::expire(instant now, packages& to) {
  constexpr duration left_lifetime = 2s;
  for (auto x = packages_.begin(); x != packages_.end();) {
    const auto oldest = x++;
    const auto age = now - oldest->if_lost.at;
    const bool leaves = account_of(oldest->account)->leaves();
    if (packages_.size() < packages_max) {
      if (age < left_lifetime)
        return;
      if (!leaves && age < package_lifetime)
        continue;
    }
    remove(oldest, to);
    account_of(oldest->account)->note_loss(oldest->if_lost);
  }
}

// One message.

void message_account::cancel() {
  if (std::exchange(state_, state::cancelled) == state::open)
    --tally_.sent;
}

/// Of two at the same time, which may be noted by two threads in any order, the larger cause and
/// place stand. That a repeat was recognised, or a greeting came, says less than any other note.
void message_account::note_loss(const loss_note& x) {
  const auto weight = [](loss cause) { return cause > loss::unanswered; };
  const auto is_newer = std::tuple(weight(x.why), x.at, x.why, x.place) >
                        std::tuple(weight(about_.cause), about_.at, about_.cause, about_.place);
  if (!is_open() || !is_newer)
    return;
  about_.cause = x.why;
  about_.at = x.at;
  about_.place = x.place;
}

bool message_account::note_arrival(std::string_view place, instant at) {
  if (std::exchange(state_, state::ended) != state::open)
    return false;
  about_.outcome = message_end::how::arrived;
  about_.place = place;
  about_.at = at;
  ++tally_.arrived;
  return true;
}

void message_account::end(std::string_view place, instant at, bool stops) {
  assert(is_open());
  state_ = state::ended;
  about_.outcome = leaves_ ? message_end::how::handed_over : message_end::how::lost;
  if (leaves_) {
    ++tally_.handed_over;
    return;
  }
  if (stops || about_.place.empty()) {
    about_.cause = stops ? loss::node_stopped : about_.cause;
    about_.place = place;
    about_.at = at;
  }
  ++tally_.lost[about_.cause];
}

// What it says.

message_ledger::tallies message_ledger::tallied() const {
  const auto now = time_here();
  const auto lock = locked();
  tallies all(tallies_.begin(), tallies_.end());
  for (const auto& [at, who] : handed_)
    all[who].handed_lately += now - at <= way_elsewhere ? 1 : 0;
  return all;
}

message_tally message_ledger::of(mote_address source, message_kind kind) const {
  const auto lock = locked();
  const auto found = tallies_.find({source, kind});
  return found == tallies_.end() ? message_tally{} : found->second;
}

message_ledger::places message_ledger::lost_at() const {
  const auto lock = locked();
  places out;
  for (const auto& [what, count] : places_)
    out[{std::get<0>(what), std::get<1>(what), std::string(std::get<2>(what))}] = count;
  return out;
}

std::map<message_ledger::sender, std::uint64_t> message_ledger::foreign_arrivals() const {
  const auto lock = locked();
  return foreign_;
}

// What senders, carriers and receivers say.

provenance begin_message(message_kind kind, mote_address source, mote_address destination) {
  auto* const who = provenance_here.who;
  if (who == nullptr)
    return provenance::none();
  const auto number = who->begin(to_string(kind), 0);
  auto* const ledger = gives_accounts ? who->ledger() : nullptr;
  return {number,
          ledger == nullptr ? account_ref() : ledger->open(number, kind, source, destination)};
}

namespace {

message_ledger* ledger_here() {
  return provenance_here.who == nullptr || !gives_accounts ? nullptr
                                                           : provenance_here.who->ledger();
}

} // namespace

void refuse_message() {
  auto* const ledger = ledger_here();
  if (ledger != nullptr && provenance_here.account != nullptr)
    ledger->cancel(static_cast<message_account&>(*provenance_here.account));
}

void note_loss(loss why) {
  auto* const ledger = ledger_here();
  if (ledger != nullptr && provenance_here.account != nullptr)
    ledger->note_loss(static_cast<message_account&>(*provenance_here.account), why);
}

void note_loss(const provenance& of, loss why) {
  auto* const ledger = ledger_here();
  if (ledger != nullptr && of.account())
    ledger->note_loss(*account_of(of.account()), why);
}

void note_arrival(message_kind kind, std::optional<mote_address> source) {
  auto* const ledger = ledger_here();
  if (ledger == nullptr)
    return;
  auto* const account = static_cast<message_account*>(provenance_here.account);
  if (account != nullptr && account->kind() == kind &&
      account->source() == source.value_or(account->source()))
    ledger->note_arrival(*account);
  else if (account == nullptr && source)
    ledger->note_foreign_arrival(*source, kind);
}

void package_departs(std::uint64_t name, bool leaves) {
  if (auto* const ledger = ledger_here())
    ledger->depart(name, leaves);
}

/// Names of packages of PEIS begin with the id of a peer, which is positive.
void hand_over() {
  static std::atomic<std::uint64_t> so_far{0}; // NOLINT
  constexpr auto of_no_peer = std::uint64_t{1} << 63U;
  package_departs(of_no_peer | ++so_far, true);
}

provenance package_comes(std::uint64_t name) {
  auto* const ledger = ledger_here();
  const auto begun = provenance::begin("package_received", name);
  return {begun.number(), ledger == nullptr ? account_ref() : ledger->come(name)};
}

} // namespace rubicon
