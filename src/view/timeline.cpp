#include "view/timeline.hpp"

#include <algorithm>

#include "view/sample_json.hpp"

namespace rubicon::view {

namespace {

/// Every second one goes, first and last stay.
template <class T>
void halve(std::vector<T>& x) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (i % 2 == 0 || i + 1 == x.size())
      x[count++] = std::move(x[i]);
  x.resize(count);
}

std::string shortened(std::string x) {
  if (x.size() > timeline::value_octets_max) {
    x.resize(timeline::value_octets_max);
    x += "...";
  }
  return x;
}

/// The last that is not later; nullptr: none.
const tuple_value* value_at(const std::vector<tuple_value>& all, instant x) {
  const auto after = std::ranges::upper_bound(all, x, {}, &tuple_value::since);
  return after == all.begin() ? nullptr : &*std::prev(after);
}

} // namespace

void timeline::add(report::run_sample x) {
  auto shared = std::make_shared<report::run_sample>(std::move(x));
  const std::lock_guard guard(lock_);
  newest_ = shared;
  if (samples_added_++ % sample_stride_ != 0)
    return;
  const bool many_motes = shared->motes.size() > motes_with_neighbours_max;
  const bool many_peers = shared->peers.size() > peers_listed_max;
  if (many_motes || many_peers) { // then neighbours and peers are stored for the present only
    auto lean = std::make_shared<report::run_sample>(*shared);
    for (auto& each : lean->motes)
      if (many_motes)
        each.neighbours = {};
    if (many_peers)
      lean->peers = {};
    shared = std::move(lean);
  }
  samples_.push_back(std::move(shared));
  thin_samples();
}

void timeline::thin_samples() {
  const auto most = std::max<std::size_t>(
      8, std::min(samples_max, mote_samples_max / std::max<std::size_t>(1, newest_->motes.size())));
  if (samples_.size() <= most)
    return;
  halve(samples_);
  sample_stride_ *= 2;
}

void timeline::add(const report::tuple_write& x) {
  const auto value = std::string_view(x.value).substr(0, value_octets_max);
  bool is_full = false;
  {
    const std::lock_guard guard(pending_lock_);
    pending_.all.push_back({x.at, static_cast<std::uint32_t>(x.owner.size()),
                            static_cast<std::uint32_t>(x.key.size()),
                            static_cast<std::uint32_t>(value.size()), x.deleted});
    (((pending_.text += x.owner) += '\0') += x.key) += value;
    is_full = pending_.all.size() >= pending_max;
  }
  if (is_full)
    flush();
}

void timeline::flush() const {
  const std::lock_guard guard(table_lock_);
  {
    const std::lock_guard other_guard(pending_lock_);
    std::swap(pending_, flushing_);
  }
  std::string_view text = flushing_.text;
  for (const auto& each : flushing_.all) {
    const std::size_t size = each.owner_size + 1 + each.key_size + each.size;
    table_.put(each, text.substr(0, size));
    text.remove_prefix(size);
  }
  flushing_.all.clear();
  flushing_.text.clear();
}

void timeline::tuple_table::put(const pending_values::value& x, std::string_view text) {
  name = text.substr(0, x.owner_size + 1 + x.key_size);
  const auto value = text.substr(name.size());
  const auto found = tuples.find(name);
  if (found != tuples.end())
    return put(found->second, x, value);
  if (tuples.size() >= tuples_max) {
    ++left_out;
    return;
  }
  auto& made = tuples[name];
  made.key = {name.substr(0, x.owner_size), name.substr(x.owner_size + 1)};
  put(made, x, value);
}

void timeline::tuple_table::put(tuple_history& to, const pending_values::value& x,
                                std::string_view text) {
  auto& all = to.values;
  if (all.empty() || all.back().since <= x.at) {
    if (!all.empty() && all.back().value == text && all.back().deleted == x.deleted)
      return;
    all.push_back({x.at, std::string(text), x.deleted});
  } else { // a record has other owners' tuples as they arrived: not always in order
    const auto where = std::ranges::upper_bound(all, x.at, {}, &tuple_value::since);
    all.insert(where, {x.at, std::string(text), x.deleted});
  }
  if (++values > values_max)
    thin();
}

void timeline::tuple_table::thin() {
  // Those of which there is little keep it: above this are at least half of all.
  const auto spared = std::max<std::size_t>(2, values_max / tuples.size() / 2);
  values = 0;
  for (auto& [key, each] : tuples) {
    if (each.values.size() > spared)
      halve(each.values);
    values += each.values.size();
  }
}

void timeline::add(listed_event x) {
  x.who = shortened(std::move(x.who));
  x.what = shortened(std::move(x.what));
  const std::lock_guard guard(lock_);
  if (events_.size() >= events_max) {
    constexpr std::size_t dropped = events_max / 8;
    events_.erase(events_.begin(), events_.begin() + dropped);
    events_forgotten_ += dropped;
  }
  events_.push_back(std::move(x));
}

void timeline::set(run_state x) {
  const std::lock_guard guard(lock_);
  state_ = x;
}

void timeline::set(std::shared_ptr<const message_list> x) {
  const std::lock_guard guard(lock_);
  messages_.swap(x); // the old ones end when nobody waits for the lock
}

void timeline::set_on_messages(std::function<void()> x) {
  const std::lock_guard guard(lock_);
  on_messages_ = std::move(x);
}

void timeline::set_why_no_messages(std::string x) {
  const std::lock_guard guard(lock_);
  why_no_messages_ = std::move(x);
}

run_state timeline::state() const {
  const std::lock_guard guard(lock_);
  return state_;
}

std::size_t timeline::samples() const {
  const std::lock_guard guard(lock_);
  return samples_added_;
}

timeline::sample timeline::newest() const {
  const std::lock_guard guard(lock_);
  return newest_;
}

timeline::sample timeline::at(instant x) const {
  const std::lock_guard guard(lock_);
  if (newest_ != nullptr && newest_->at <= x)
    return newest_;
  const auto after =
      std::ranges::upper_bound(samples_, x, {}, [](const sample& each) { return each->at; });
  return after == samples_.begin() ? nullptr : *std::prev(after);
}

std::vector<timeline::sample> timeline::all_samples() const {
  const std::lock_guard guard(lock_);
  auto all = samples_;
  if (newest_ != nullptr && (all.empty() || all.back()->at < newest_->at))
    all.push_back(newest_);
  return all;
}

timeline::events_then timeline::events_from(std::uint64_t number) const {
  const std::lock_guard guard(lock_);
  events_then x{{}, events_forgotten_ + events_.size()};
  const auto first = std::max(number, events_forgotten_) - events_forgotten_;
  if (first < events_.size())
    x.events.assign(events_.begin() + static_cast<std::ptrdiff_t>(first), events_.end());
  return x;
}

std::uint64_t timeline::events() const {
  const std::lock_guard guard(lock_);
  return events_forgotten_ + events_.size();
}

std::optional<listed_event> timeline::event_after(instant x) const {
  const std::lock_guard guard(lock_);
  std::optional<listed_event> next; // violations found at the end are of earlier times
  for (const auto& each : events_)
    if (each.at > x && (!next || each.at < next->at))
      next = each;
  return next;
}

timeline::tuples_then timeline::tuples_at(instant x) const {
  flush();
  tuples_then all;
  {
    const std::lock_guard guard(table_lock_);
    all.left_out = table_.left_out;
    for (const auto& [name, each] : table_.tuples) {
      const auto* value = value_at(each.values, x);
      if (value != nullptr && !value->deleted)
        all.tuples.emplace_back(each.key, *value);
    }
  }
  std::ranges::sort(all.tuples, {}, &std::pair<tuple_key, tuple_value>::first);
  return all;
}

std::vector<tuple_value> timeline::values_of(const tuple_key& x) const {
  flush();
  const std::lock_guard guard(table_lock_);
  const auto found = table_.tuples.find(x.first + '\0' + x.second);
  return found == table_.tuples.end() ? std::vector<tuple_value>() : found->second.values;
}

std::shared_ptr<const message_list> timeline::messages() const {
  std::unique_lock guard(lock_);
  auto found = messages_;
  const auto ask = on_messages_;
  guard.unlock();
  if (ask)
    ask();
  return found;
}

std::string timeline::why_no_messages() const {
  const std::lock_guard guard(lock_);
  return why_no_messages_;
}

} // namespace rubicon::view
