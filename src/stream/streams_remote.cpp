// Remote streams: set-up, records and end of their channels (D1.1 3.3.3.2, Figures 6 and 7).
#include "stream/streams.hpp"

#include <algorithm>

namespace rubicon::stream {

namespace {

/// A read end that is further behind has received from another life of the write end.
constexpr std::uint16_t resume_span = 1024;

} // namespace

answer streams::open_remote(mote_address self, const remote_request& x, instant now,
                            duration far_slack) {
  auto destination = x.destination;
  if (destination.island == own_island)
    destination.island = self.island;
  if (destination.mote == own_mote)
    destination.mote = self.mote;
  if (destination.mote == broadcast_mote || x.rate.count() < 0 || !queue_fits(x.queue_size) ||
      x.buffer_size == 0 || x.buffer_size > config_.record_max)
    return {.refused = failure::bad_argument};
  const bool reads = destination == self && !x.writes_to_self;
  const auto what = reads ? kind::reader : kind::writer;
  if (find(what, x.name) != nullptr)
    return {.refused = failure::already_open};
  if (rows_.size() >= config_.streams_max)
    return {.refused = failure::no_room};
  auto& added = add(what, x.buffer_size, reads ? x.queue_size : 0);
  added.name = x.name;
  added.far_slack = far_slack;
  added.loops = !reads && destination == self;
  answer done{.stream = added.id};
  if (reads)
    start_reader(added, done.todo, now);
  else
    start_writer(added, x, destination, done.todo, now);
  return done;
}

void streams::start_writer(row& x, const remote_request& request, mote_address destination,
                           outputs& todo, instant now) {
  if (x.loops) {
    opened(x, todo);
    if (auto* reader = find(kind::reader, x.name); reader && reader->at == phase::waiting) {
      reader->loops = true;
      opened(*reader, todo);
    }
    return;
  }
  x.at = phase::connecting;
  x.other = destination;
  x.is_reliable = (request.qos & (qos_reliable | qos_every_value)) != 0;
  if (const auto* before = recall(kind::writer, x.name, x.other); before && !x.is_reliable) {
    x.sequence = before->sequence;
    x.last_write = before->last_write;
    if (now - before->last_write <= config_.resume_within)
      x.recent = before->recent;
  }
  x.gives_up = now + patience(x.far_slack);
  x.due = x.gives_up;
  todo.emplace_back(connect_channel{x.id, destination, request.rate,
                                    write_header_size + request.buffer_size, request.qos});
}

/// The read end is passive: it finds that the write end has been here, or waits for it.
void streams::start_reader(row& x, outputs& todo, instant now) {
  const auto here =
      std::find_if(early_.begin(), early_.end(), [&](const early& y) { return y.name == x.name; });
  if (here != early_.end()) {
    take_channel(x, *here, todo);
    early_.erase(here);
  } else if (auto* writer = find(kind::writer, x.name); writer && writer->loops) {
    x.loops = true;
    opened(x, todo);
  } else {
    x.at = phase::waiting;
    x.due = now + config_.reader_patience;
  }
}

void streams::take_channel(row& x, const early& from, outputs& todo) {
  x.channel = from.channel;
  x.other = from.source;
  x.sequence = from.sequence;
  x.is_reliable = from.is_reliable;
  counters_.lost += from.lost;
  counters_.resumed += from.resumed;
  opened(x, todo);
  if (!from.records.empty())
    x.queue = bounded_queue<bytes>(x.queue.capacity() + from.records.size(), overflow::drop_oldest);
  for (const auto& record : from.records)
    deliver(x, record, todo);
}

/// Octets of records that SS_OPEN holds, one more for each counted.
std::size_t streams::recent_max() const {
  constexpr auto more = open_header_size - write_header_size;
  return config_.record_max > more ? config_.record_max - more : 0;
}

/// Adds one to the last records, and drops the oldest until SS_OPEN holds them.
/// @returns how many it has dropped
std::size_t streams::keep_recent(std::vector<bytes>& recent, byte_view record) const {
  recent.push_back(to_bytes(record));
  std::size_t octets = 0;
  for (const auto& each : recent)
    octets += 1 + each.size();
  auto kept = recent.begin();
  for (; octets > recent_max(); ++kept)
    octets -= 1 + kept->size();
  const auto dropped = static_cast<std::size_t>(kept - recent.begin());
  recent.erase(recent.begin(), kept);
  return dropped;
}

/// It has come before the application has opened; one of a reliable stream comes again.
void streams::on_early_record(early& x, const write_message& content) {
  const auto ahead = static_cast<std::int16_t>(content.sequence - x.sequence);
  if (x.is_reliable) {
    ++counters_.unclaimed;
    return;
  }
  if (ahead < 0) {
    ++counters_.repeated;
    return;
  }
  x.lost += static_cast<std::uint64_t>(ahead);
  x.sequence = static_cast<std::uint16_t>(content.sequence + 1);
  const auto dropped = keep_recent(x.records, content.record);
  counters_.unclaimed += dropped;
  x.resumed -= std::min(x.resumed, dropped);
}

/// The application has not opened in time.
void streams::give_up(const early& x) {
  counters_.unclaimed += x.records.size() - x.resumed;
}

void streams::remember(row& x) {
  if (x.at != phase::open || x.is_reliable || x.loops ||
      (x.what != kind::writer && x.what != kind::reader))
    return;
  std::erase_if(past_, [&](const past& y) { return y.what == x.what && y.name == x.name; });
  if (past_.size() >= config_.streams_max)
    past_.erase(past_.begin());
  past_.push_back({x.what, x.name, x.other, x.sequence, std::move(x.recent), x.last_write});
  x.recent.clear();
}

const streams::past* streams::recall(kind what, std::uint16_t name, mote_address other) const {
  const auto found = std::ranges::find_if(
      past_, [&](const past& x) { return x.what == what && x.name == name && x.other == other; });
  return found == past_.end() ? nullptr : &*found;
}

/// What the read end lacks of what the write end has written before this channel. After a reboot
/// of either the two do not know how far they were, and begin with the channel.
void streams::resume(early& x, const open_message& request) {
  x.sequence = request.sequence;
  const auto* before = recall(kind::reader, *x.name, x.source);
  if (before == nullptr)
    return;
  const auto behind = static_cast<std::uint16_t>(request.sequence - before->sequence);
  if (behind > resume_span)
    return;
  const auto had = request.recent.size() - std::min<std::size_t>(behind, request.recent.size());
  x.records.assign(request.recent.begin() + static_cast<std::ptrdiff_t>(had), request.recent.end());
  x.resumed = x.records.size();
  x.lost = behind - x.resumed;
}

void streams::opened(row& x, outputs& todo) {
  ++counters_.opened;
  x.at = phase::open;
  x.due.reset();
  todo.emplace_back(open_done{x.id, x.name, true});
}

void streams::ask(row& x, outputs& todo, instant now) {
  x.at = phase::asking;
  x.due = std::min(now + repeat_wait(x), x.gives_up);
  const auto qos = x.is_reliable ? qos_reliable : std::uint8_t{0};
  todo.emplace_back(
      send_on_channel{*x.channel, encode(open_message{x.name, qos, x.sequence, x.recent})});
}

outputs streams::on_connected(descriptor stream, channel_handle channel, instant now) {
  outputs todo;
  auto* x = find(stream);
  if (x == nullptr || x->at != phase::connecting) {
    todo.emplace_back(disconnect{channel}); // closed or given up in the meantime
    return todo;
  }
  x->channel = channel;
  ask(*x, todo, now);
  return todo;
}

outputs streams::on_connect_failed(descriptor stream) {
  outputs todo;
  if (auto* x = find(stream); x != nullptr && x->at == phase::connecting)
    drop(*x, todo);
  return todo;
}

outputs streams::on_accepted(channel_handle channel, mote_address source, instant now,
                             duration far_slack) {
  if (early_.size() < config_.early_max) {
    early_.push_back({channel, source, std::nullopt, 0, now + patience(far_slack)});
    return {};
  }
  ++counters_.refused;
  return {disconnect{channel}};
}

outputs streams::on_channel_closed(channel_handle channel) {
  outputs todo;
  std::erase_if(early_, [&](const early& x) {
    if (x.channel != channel)
      return false;
    give_up(x);
    return true;
  });
  if (auto* x = find(channel)) {
    x->channel.reset();
    if (is_opening(*x))
      drop(*x, todo);
    else
      end(*x, todo);
  }
  return todo;
}

outputs streams::on_channel_octets(channel_handle channel, byte_view octets, instant now) {
  outputs todo;
  const auto content = decode_message(octets);
  if (!content) {
    ++counters_.malformed;
    return todo;
  }
  if (auto* x = find(channel)) {
    on_row_message(*x, *content, todo, now);
    return todo;
  }
  const auto found = std::find_if(early_.begin(), early_.end(),
                                  [&](const early& x) { return x.channel == channel; });
  const auto* open = std::get_if<open_message>(&*content);
  const auto* record = std::get_if<write_message>(&*content);
  if (found != early_.end() && open != nullptr) {
    const auto x = *found;
    early_.erase(found);
    on_open(x, *open, todo, now);
  } else if (found != early_.end() && found->name && record != nullptr) {
    on_early_record(*found, *record);
  } else {
    ++counters_.strays;
  }
  return todo;
}

/// SS_OPEN over a channel that is no stream's yet. It is acknowledged whether or not the
/// application has opened (STR-13); if it has, it is notified now (STR-14).
void streams::on_open(early x, const open_message& request, outputs& todo, instant now) {
  const auto name = request.name;
  x.is_reliable = (request.qos & qos_reliable) != 0;
  const bool repeated = x.name == name;
  if (!repeated && !free_name(x, name, todo)) {
    ++counters_.refused;
    todo.emplace_back(disconnect{x.channel});
    return;
  }
  if (!repeated) {
    x.name = name;
    x.due = now + config_.reader_patience;
    resume(x, request);
  }
  todo.emplace_back(send_on_channel{x.channel, encode(open_ack_message{name})});
  if (auto* reader = find(kind::reader, name); reader && reader->at == phase::waiting) {
    take_channel(*reader, x, todo);
    return;
  }
  early_.push_back(std::move(x));
}

/// A node that opens a stream anew has lost its old channel, which we may not know yet. Another
/// node must not use the same name.
/// @returns whether `x` may have the name
bool streams::free_name(const early& x, std::uint16_t name, outputs& todo) {
  if (x.name)
    return false;
  const auto rival =
      std::find_if(early_.begin(), early_.end(), [&](const early& y) { return y.name == name; });
  if (rival != early_.end()) {
    if (rival->source != x.source)
      return false;
    todo.emplace_back(disconnect{rival->channel});
    give_up(*rival);
    early_.erase(rival);
  }
  auto* reader = find(kind::reader, name);
  if (reader == nullptr || reader->at != phase::open)
    return true;
  if (reader->loops || reader->other != x.source)
    return false;
  todo.emplace_back(disconnect{*reader->channel});
  end(*reader, todo);
  return true;
}

void streams::on_row_message(row& x, const message& content, outputs& todo, instant now) {
  const auto* open = std::get_if<open_message>(&content);
  const auto* ack = std::get_if<open_ack_message>(&content);
  const auto* record = std::get_if<write_message>(&content);
  const auto* arrived = std::get_if<ack_message>(&content);
  if (x.what == kind::reader && record != nullptr) {
    if (x.is_reliable)
      on_reliable_record(x, *record, todo);
    else
      on_record(x, *record, todo);
  } else if (x.what == kind::writer && x.is_reliable && arrived != nullptr) {
    on_ack(x, arrived->next, now);
  } else if (x.what == kind::reader && open != nullptr && open->name == x.name) {
    todo.emplace_back(send_on_channel{*x.channel, encode(open_ack_message{x.name})});
  } else if (x.what == kind::writer && ack != nullptr && ack->name == x.name) {
    if (x.at == phase::asking)
      opened(x, todo);
  } else {
    ++counters_.strays;
  }
}

void streams::on_record(row& x, const write_message& content, outputs& todo) {
  const auto ahead = static_cast<std::int16_t>(content.sequence - x.sequence);
  if (ahead < 0) {
    ++counters_.repeated;
    return;
  }
  counters_.lost += static_cast<std::uint64_t>(ahead);
  x.sequence = static_cast<std::uint16_t>(content.sequence + 1);
  deliver(x, content.record, todo);
}

/// One after the other: what comes too early will come again.
void streams::on_reliable_record(row& x, const write_message& content, outputs& todo) {
  const auto ahead = static_cast<std::int16_t>(content.sequence - x.sequence);
  if (ahead == 0 && x.queue.full() && !x.reading) {
    ++counters_.throttled;
    return;
  }
  if (ahead < 0)
    ++counters_.repeated;
  if (ahead == 0)
    ++x.sequence;
  todo.emplace_back(send_on_channel{*x.channel, encode(ack_message{x.sequence})});
  if (ahead == 0)
    deliver(x, content.record, todo);
}

void streams::on_ack(row& x, std::uint16_t next, instant now) {
  const auto acked = static_cast<std::uint16_t>(next - x.first_unacked);
  if (acked == 0 || acked > x.unacked.size())
    return; // it is known, or of another stream
  x.unacked.erase(x.unacked.begin(), x.unacked.begin() + acked);
  x.first_unacked = next;
  x.resends = 0;
  x.due.reset();
  if (!x.unacked.empty())
    x.due = now + repeat_wait(x);
}

void streams::resend(row& x, outputs& todo, instant now) {
  if (++x.resends > config_.resends_max) {
    todo.emplace_back(disconnect{*x.channel});
    end(x, todo);
    return;
  }
  auto sequence = x.first_unacked;
  for (const auto& record : x.unacked) {
    ++counters_.resent;
    todo.emplace_back(send_on_channel{*x.channel, encode(write_message{sequence++, record})});
  }
  x.due = now + repeat_wait(x);
}

void streams::deliver(row& x, byte_view record, outputs& todo) {
  if (record.size() > x.record_max)
    ++counters_.oversized;
  else
    store(x, to_bytes(record), todo);
}

streams::row* streams::find(kind what, std::uint16_t name) {
  const auto found = std::find_if(rows_.begin(), rows_.end(),
                                  [&](const row& x) { return x.what == what && x.name == name; });
  return found == rows_.end() ? nullptr : &*found;
}

streams::row* streams::find(channel_handle channel) {
  const auto found =
      std::find_if(rows_.begin(), rows_.end(), [&](const row& x) { return x.channel == channel; });
  return found == rows_.end() ? nullptr : &*found;
}

} // namespace rubicon::stream
