#include "stream/streams.hpp"

#include <algorithm>

namespace rubicon::stream {

namespace {

constexpr std::uint16_t descriptor_max = 32767;

answer refuse(failure why) {
  return {.refused = why};
}

} // namespace

std::string_view to_string(failure x) {
  switch (x) {
  case failure::bad_descriptor:
    return "bad_descriptor";
  case failure::illegal_operation:
    return "illegal_operation";
  case failure::no_room:
    return "no_room";
  case failure::already_open:
    return "already_open";
  case failure::too_long:
    return "too_long";
  case failure::not_open_yet:
    return "not_open_yet";
  case failure::bad_argument:
    return "bad_argument";
  case failure::busy:
    return "busy";
  case failure::ended:
    return "ended";
  }
  return "unknown";
}

answer streams::open_sensor(const sensor_request& x, instant now) {
  const bool periodic = x.kind == sampling::periodic;
  if (x.transducer >= config_.transducers || !queue_fits(x.queue_size) ||
      (periodic && x.period.count() <= 0))
    return refuse(failure::bad_argument);
  if (rows_.size() >= config_.streams_max)
    return refuse(failure::no_room);
  auto& added = add(kind::sensor, sensor_record::size, x.queue_size);
  added.sensor = x;
  if (periodic)
    added.due = now + x.period;
  return {.stream = added.id};
}

answer streams::open_local(std::size_t queue_size) {
  if (!queue_fits(queue_size))
    return refuse(failure::bad_argument);
  if (rows_.size() >= config_.streams_max)
    return refuse(failure::no_room);
  return {.stream = add(kind::local, config_.record_max, queue_size).id};
}

answer streams::write(descriptor stream, byte_view record, instant now) {
  auto* x = find(stream);
  if (x == nullptr)
    return refuse(failure::bad_descriptor);
  if (x->what == kind::sensor || x->what == kind::reader)
    return refuse(failure::illegal_operation);
  if (is_opening(*x))
    return refuse(failure::not_open_yet);
  if (x->at == phase::ended)
    return refuse(failure::ended);
  if (record.size() > x->record_max)
    return refuse(failure::too_long);
  if (x->is_reliable && x->unacked.size() >= config_.window_max) {
    ++counters_.busy;
    return refuse(failure::busy);
  }
  answer done{.stream = stream};
  if (x->channel) {
    const write_message content{x->sequence++, to_bytes(record)};
    done.todo.emplace_back(send_on_channel{*x->channel, encode(content)});
    if (x->is_reliable) {
      x->unacked.push_back(content.record);
      x->due = x->due.value_or(now + repeat_wait(*x));
    } else {
      x->last_write = now;
      keep_recent(x->recent, record);
    }
  } else if (x->what == kind::local) {
    store(*x, to_bytes(record), done.todo);
  } else if (auto* reader = find(kind::reader, x->name); reader != nullptr && reader->loops) {
    deliver(*reader, record, done.todo);
  } else {
    ++counters_.unclaimed;
  }
  return done;
}

answer streams::read(descriptor stream, std::size_t nbytes) {
  auto* x = find(stream);
  if (x == nullptr)
    return refuse(failure::bad_descriptor);
  if (x->what == kind::writer)
    return refuse(failure::illegal_operation);
  if (is_opening(*x))
    return refuse(failure::not_open_yet);
  if (x->reading)
    return refuse(failure::busy);
  if (nbytes == 0)
    return refuse(failure::bad_argument);
  if (x->at == phase::ended && x->queue.empty())
    return refuse(failure::ended);
  answer done{.stream = stream};
  x->reading = nbytes;
  if (!x->queue.empty()) {
    serve(*x, done.todo);
  } else if (x->what == kind::sensor && x->sensor.kind == sampling::on_demand) {
    x->sampling = true;
    done.todo.emplace_back(sample{stream, x->sensor.transducer});
  }
  return done;
}

answer streams::close(descriptor stream) {
  auto* x = find(stream);
  if (x == nullptr)
    return refuse(failure::bad_descriptor);
  answer done{.stream = stream};
  drop(*x, done.todo);
  return done;
}

outputs streams::on_sample(descriptor stream, const sensor_record& x) {
  outputs todo;
  auto* at = find(stream);
  if (at == nullptr || !at->sampling) {
    ++counters_.strays;
    return todo;
  }
  at->sampling = false;
  store(*at, encode(x), todo);
  return todo;
}

outputs streams::on_time(instant now) {
  outputs todo;
  for (std::size_t i = 0; i < rows_.size();) {
    const bool is_due = rows_[i].due && *rows_[i].due <= now;
    if (!is_due || on_due(rows_[i], todo, now))
      ++i;
  }
  std::erase_if(early_, [&](const early& x) {
    if (x.due > now)
      return false;
    ++counters_.expired;
    give_up(x);
    todo.emplace_back(disconnect{x.channel});
    return true;
  });
  return todo;
}

std::optional<instant> streams::deadline() const {
  std::optional<instant> next;
  for (const auto& x : rows_)
    next = earliest(next, x.due);
  for (const auto& x : early_)
    next = earliest(next, x.due);
  return next;
}

std::size_t streams::footprint() const {
  constexpr std::size_t row_size = 30;
  constexpr std::size_t past_size = 12; // its records are where its row had them
  constexpr std::size_t early_size = 13;
  constexpr std::size_t queue_size = queue_size_default * (1 + buffer_size_default);
  const auto records = std::max(queue_size, recent_max()); // of a reader, of a writer
  return config_.streams_max * (row_size + past_size + records) +
         config_.early_max * (early_size + recent_max());
}

/// @returns whether the row is still there
bool streams::on_due(row& x, outputs& todo, instant now) {
  if (x.what == kind::sensor) {
    const auto late = (now - *x.due) / duration(x.sensor.period);
    counters_.missed += static_cast<std::uint64_t>(late);
    *x.due += (late + 1) * duration(x.sensor.period);
    x.sampling = true;
    todo.emplace_back(sample{x.id, x.sensor.transducer});
    return true;
  }
  if (x.at == phase::asking && now < x.gives_up) {
    ask(x, todo, now);
    return true;
  }
  if (x.at == phase::open) {
    resend(x, todo, now);
    return true;
  }
  drop(x, todo);
  return false;
}

std::optional<channel_handle> streams::channel_of(descriptor stream) const {
  const auto found = std::ranges::find(rows_, stream, &row::id);
  if (found == rows_.end() || found->at != phase::open)
    return std::nullopt;
  return found->channel;
}

bool streams::is_sensor(descriptor stream) const {
  return std::ranges::any_of(
      rows_, [stream](const row& x) { return x.id == stream && x.what == kind::sensor; });
}

bool streams::has_ended(descriptor stream) const {
  return std::ranges::any_of(rows_, [stream](const row& x) {
    return x.id == stream && x.at == phase::ended && x.queue.empty();
  });
}

streams::row* streams::find(descriptor stream) {
  const auto found =
      std::find_if(rows_.begin(), rows_.end(), [&](const row& x) { return x.id == stream; });
  return found == rows_.end() ? nullptr : &*found;
}

streams::row& streams::add(kind what, std::size_t record_max, std::size_t queue_size) {
  do
    last_.value = static_cast<std::uint16_t>(last_.value % descriptor_max + 1);
  while (find(last_) != nullptr);
  bounded_queue<bytes> queue(queue_size, overflow::drop_oldest);
  rows_.push_back({.id = last_, .what = what, .record_max = record_max, .queue = std::move(queue)});
  return rows_.back();
}

void streams::drop(row& x, outputs& todo) {
  const auto id = x.id;
  if (is_opening(x)) {
    ++counters_.open_failed;
    todo.emplace_back(open_done{id, x.name, false});
  }
  if (x.channel)
    todo.emplace_back(disconnect{*x.channel});
  auto* other = find(x.what == kind::reader ? kind::writer : kind::reader, x.name);
  if (x.loops && other != nullptr && other->loops)
    end(*other, todo);
  end(x, todo);
  std::erase_if(rows_, [&](const row& y) { return y.id == id; });
}

void streams::end(row& x, outputs& todo) {
  remember(x);
  x.at = phase::ended;
  counters_.unconfirmed += x.unacked.size();
  x.unacked.clear();
  x.channel.reset();
  x.loops = false;
  x.due.reset();
  if (x.reading) {
    x.reading.reset();
    todo.emplace_back(read_done{x.id, {}, false});
  }
}

void streams::store(row& x, bytes record, outputs& todo) {
  ++counters_.stored;
  if (x.queue.full())
    ++counters_.dropped;
  x.queue.push(std::move(record));
  if (x.reading)
    serve(x, todo);
}

void streams::serve(row& x, outputs& todo) {
  auto record = x.queue.pop();
  if (record.size() > *x.reading) {
    counters_.excess_octets += record.size() - *x.reading;
    record.resize(*x.reading);
  }
  x.reading.reset();
  ++counters_.read;
  todo.emplace_back(read_done{x.id, std::move(record), true});
}

} // namespace rubicon::stream
