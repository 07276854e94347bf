#include "peis/space/own_tuples.hpp"

#include <algorithm>

#include "peis/tuples/tuple_append.hpp"
#include "peis/tuples/tuple_record.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t appends_look_at_max = 8192; ///< tuples, for one request of another

} // namespace

own_tuples::own_tuples(const tuple_space_config& config, peer_id self, tuple_store& store,
                       tuple_hosts& hosts, const tuple_clock& clock)
    : config_(config), self_(self), store_(store), hosts_(hosts), clock_(clock),
      drafts_(self, clock) {}

bool own_tuples::is_full(const key& name) const {
  return store_.size() >= config_.tuples_max && find(name) == nullptr;
}

own_result own_tuples::set(const key& name, tuple_content content, instant now) {
  auto x = drafts_.draft(self_, name, std::move(content));
  if (x && !name.is_pattern())
    return insert(std::move(*x), now);
  ++counters_.refused;
  return {x ? cause::bad_key : cause::bad_value, {}};
}

own_result own_tuples::insert(tuple x, instant now) {
  auto why = drafts_.complete(x, now);
  if (why == cause::none && is_full(x.name))
    why = cause::space_full;
  if (why != cause::none) {
    ++counters_.refused;
    return {why, {}};
  }
  if (x.expiry == deleted)
    return {why, remove(x.name, now)};
  return {why, store_whole(std::move(x), {})};
}

tuple_pointer own_tuples::put(tuple x, tuple_store::source by) {
  const auto held = store_.size();
  const auto expiry = clock_.expiry_of(x);
  auto stored = store_.put(std::move(x), expiry, by);
  keys_version_ += store_.size() != held ? 1 : 0;
  return stored;
}

own_change own_tuples::store_whole(tuple x, tuple_store::source by) {
  ++counters_.sets;
  const auto* held = find(x.name);
  x.seqno = held != nullptr ? held->content->seqno + 1 : first_seqno_;
  x.append_seqno = 0;
  return own_value_set{put(std::move(x), by)};
}

void own_tuples::forget(const tuple& gone) {
  first_seqno_ = std::max(first_seqno_, gone.seqno + 2); // a deletion may have had one of its own
  ++keys_version_;
}

std::optional<own_change> own_tuples::remove(const key& name, instant now) {
  auto gone = store_.remove(self_, name);
  if (!gone)
    return std::nullopt;
  forget(*gone);
  auto last = *gone;
  last.seqno = gone->seqno + 1;
  last.written = clock_.network_time(now);
  make_deletion(last);
  last.from = {};
  return own_value_deleted{std::move(gone), std::move(last)};
}

std::optional<tuple> own_tuples::decode_set(const payload& octets, instant now) {
  auto x = decode_tuple_message(octets, clock_.network_time(now));
  if (!x || x->owner != self_) {
    ++counters_.malformed;
    return std::nullopt;
  }
  return std::move(*x);
}

std::optional<own_change> own_tuples::on_set(peer_id source, const tuple& x, bool may_write,
                                             instant now) {
  if (!may_write) {
    ++counters_.refused;
    return std::nullopt;
  }
  if (x.expiry == deleted) {
    ++counters_.remote_sets;
    return remove(x.name, now);
  }
  const tuple_store::source by{tuple_store::origin::written, source};
  if (is_full(x.name) || !store_.admits(x, by)) {
    ++counters_.overflow;
    return std::nullopt;
  }
  if (!hosts_.admit(source, now))
    return std::nullopt;
  ++counters_.remote_sets;
  auto own = x;
  own.written = clock_.network_time(now);
  return store_whole(std::move(own), by);
}

std::optional<std::vector<tuple_pointer>> own_tuples::find_appendable(const prototype& wanted) {
  std::vector<tuple_pointer> found;
  std::string after;
  std::size_t looked_at = 0;
  const bool through = walk_on(wanted.name, after, [&](const auto& x) {
    const bool matches = wanted.matches(*x.content);
    if (matches && is_reserved(x.content->name))
      ++counters_.refused;
    else if (matches)
      found.push_back(x.content);
    return ++looked_at <= appends_look_at_max && found.size() <= config_.append_matches_max;
  });
  work_.add(looked_at / 2);
  return through ? std::optional(std::move(found)) : std::nullopt;
}

own_result own_tuples::append(const tuple_pointer& held, const payload& added,
                              std::optional<peer_id> writer, bool notices) {
  const auto by =
      writer ? tuple_store::source{tuple_store::origin::written, *writer} : find(held->name)->by;
  const bool text = held->form == encoding::text;
  auto tail = text && !ends_with_nul(added) ? with_nul(added) : added;
  const auto size = octets_before_append(*held) + tail.size();
  if (size > tuple_value_max) {
    ++counters_.overflow;
    return {cause::too_long, {}};
  }
  auto next = *held;
  const bool ends_badly = text && !held->value.empty() && !ends_with_nul(held->value);
  if (ends_badly)
    next.value = with_nul(held->value); // or its last character would be lost
  next.value = appended_value(next, tail);
  work_.add(size / append_octets_per_unit);
  if (by.from == tuple_store::origin::written && !store_.admits(next, by)) {
    ++counters_.overflow;
    return {cause::space_full, {}};
  }
  ++counters_.appends;
  if (notices && !ends_badly) {
    ++next.append_seqno;
    return {cause::none, own_value_appended{held, put(std::move(next), by), std::move(tail)}};
  }
  if (next.mimetype == empty_mimetype)
    next.mimetype = text ? text_mimetype : binary_mimetype;
  ++next.seqno;
  next.append_seqno = 0;
  return {cause::none, own_value_extended{put(std::move(next), by)}};
}

void own_tuples::renumber(const key& name) {
  const auto* held = find(name);
  if (held == nullptr)
    return;
  const bool is_new = held->is_new;
  auto same = *held->content;
  ++same.seqno;
  same.append_seqno = 0;
  static_cast<void>(put(std::move(same), held->by));
  find(name)->is_new = is_new;
}

tuple own_tuples::deletion_of(const key& name, instant now) const {
  tuple x;
  x.owner = x.creator = self_;
  x.name = name;
  x.seqno = first_seqno_ - 1; // no less than any deletion has had
  x.written = clock_.network_time(now);
  make_deletion(x);
  return x;
}

void own_tuples::on_expired(const tuple& gone) {
  forget(gone);
}

void own_tuples::on_writer_gone(peer_id host, instant now) {
  if (store_.written().of(host) > 0 && !next_orphan_)
    next_orphan_ = now + config_.orphan_age;
}

std::vector<key> own_tuples::take_orphans(instant now) {
  std::vector<key> orphans;
  if (!next_orphan_ || *next_orphan_ > now)
    return orphans;
  next_orphan_.reset();
  std::vector<std::pair<std::size_t, key>> found;
  std::size_t octets = 0;
  if (store_.written().total() > config_.orphaned_octets_max) {
    store_.for_matching(prototype_of(self_, key()), [&](const tuple_store::entry& x) {
      if (!x.created_by_other || hosts_.is_present(x.by.host))
        return;
      found.emplace_back(x.weight, x.content->name);
      octets += x.weight;
    });
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (auto& [weight, name] : found) {
    if (octets <= config_.orphaned_octets_max)
      break;
    octets -= weight;
    ++counters_.orphans_removed;
    orphans.push_back(std::move(name));
  }
  return orphans;
}

} // namespace rubicon::peis
