// How synaptic channels come about and end (SYN-01..05, SYN-14, SYN-15, SYN-17).
#include "synaptic/channels.hpp"

#include <algorithm>

namespace rubicon::synaptic {

namespace {

constexpr std::uint16_t descriptor_max = 32767;

mote_address resolved(mote_address x, mote_address self, const parameters& requested) {
  if (x.island == own_island)
    x.island = requested.island == own_island ? self.island : requested.island;
  if (x.mote == own_mote)
    x.mote = self.mote;
  return x;
}

} // namespace

answer channels::create_out(mote_address self, mote_address destination, std::size_t size,
                            const parameters& x, instant now, duration far_slack) {
  const auto other = resolved(destination, self, x);
  auto done = create(self, other, {.is_out = true}, size, x);
  if (done.refused)
    return done;
  auto& added = rows_.back();
  added.values.resize(size);
  added.far_slack = far_slack;
  added.gives_up = now + patience(far_slack);
  added.due = added.gives_up;
  if (added.loops) {
    join_own(added, done.todo);
    return done;
  }
  added.at = phase::connecting;
  const auto packet_size = std::min(config_.packet_max, vector_header_size + size * value_size);
  done.todo.emplace_back(connect_channel{added.id, other, config_.tick_period * added.shape.divisor,
                                         packet_size, x.qos});
  return done;
}

/// The in end is passive: it finds that the out end has been here, or waits for it.
answer channels::create_in(mote_address self, mote_address source, std::size_t size,
                           const parameters& x, instant now, duration far_slack) {
  auto done = create(self, resolved(source, self, x), {.is_out = false}, size, x);
  if (done.refused)
    return done;
  auto& added = rows_.back();
  added.input = arrivals(added.shape.size, added.shape.divisor);
  added.due = now + config_.reader_patience + 2 * (answer_slack_ + far_slack);
  if (added.loops)
    join_own(added, done.todo);
  else
    join_early(added, done.todo);
  return done;
}

answer channels::create(mote_address self, mote_address other, row added, std::size_t size,
                        const parameters& x) {
  if (other.mote == broadcast_mote || size == 0 || size > config_.size_max)
    return {.refused = failure::bad_argument};
  if (find(added.is_out, other) != nullptr)
    return {.refused = failure::already_open};
  const auto used = std::count_if(rows_.begin(), rows_.end(),
                                  [&](const row& y) { return y.is_out == added.is_out; });
  if (static_cast<std::size_t>(used) >= config_.channels_max)
    return {.refused = failure::no_room};
  do
    last_.value = static_cast<std::uint16_t>(last_.value % descriptor_max + 1);
  while (find(last_) != nullptr);
  added.id = last_;
  added.other = other;
  added.loops = other == self;
  added.shape = {static_cast<std::uint8_t>(size), std::max<std::uint8_t>(x.divisor, 1)};
  rows_.push_back(std::move(added));
  return {.channel = last_};
}

/// Both ends are ours; the one created last finds the other.
void channels::join_own(row& x, outputs& todo) {
  auto* other = find(!x.is_out, x.other);
  if (other == nullptr)
    return;
  if (other->shape == x.shape) {
    opened(x, todo);
    opened(*other, todo);
    return;
  }
  const auto second = x.id;
  drop(other->id, todo);
  drop(second, todo);
}

void channels::join_early(row& x, outputs& todo) {
  const auto here = std::find_if(early_.begin(), early_.end(),
                                 [&](const early& y) { return y.request && y.source == x.other; });
  if (here == early_.end())
    return;
  const auto from = *here;
  early_.erase(here);
  on_open(from, todo);
}

void channels::opened(row& x, outputs& todo) {
  ++counters_.created;
  x.at = phase::open;
  x.due.reset();
  todo.emplace_back(create_done{x.id, x.is_out, true});
}

void channels::ask(row& x, outputs& todo, instant now) {
  x.at = phase::asking;
  x.due = std::min(now + config_.open_repeat + answer_slack_ + x.far_slack, x.gives_up);
  todo.emplace_back(send_on_channel{*x.channel, encode(x.shape)});
}

/// An open channel is gone; its entry stays until it is disposed of.
void channels::end(row& x, outputs& todo) {
  ++counters_.failed;
  if (x.channel)
    todo.emplace_back(disconnect{*x.channel});
  x.at = phase::ended;
  x.channel.reset();
  x.is_active = false;
  x.sends = false;
  x.stops_left = 0;
  todo.emplace_back(channel_failed{x.id});
}

/// Pointers to rows are void afterwards.
void channels::drop(descriptor id, outputs& todo) {
  const auto& x = *find(id);
  if (is_opening(x)) {
    ++counters_.create_failed;
    todo.emplace_back(create_done{id, x.is_out, false});
  }
  if (x.channel)
    todo.emplace_back(disconnect{*x.channel});
  if (auto* other = find(!x.is_out, x.other); x.loops && x.at == phase::open && other != nullptr)
    end(*other, todo);
  std::erase_if(rows_, [&](const row& y) { return y.id == id; });
}

outputs channels::on_connected(descriptor channel, channel_handle handle, instant now) {
  outputs todo;
  auto* x = find(channel);
  if (x == nullptr || x->at != phase::connecting) {
    todo.emplace_back(disconnect{handle}); // disposed of or given up in the meantime
    return todo;
  }
  x->channel = handle;
  ask(*x, todo, now);
  return todo;
}

outputs channels::on_connect_failed(descriptor channel) {
  outputs todo;
  if (auto* x = find(channel); x != nullptr && x->at == phase::connecting)
    drop(channel, todo);
  return todo;
}

outputs channels::on_accepted(channel_handle handle, mote_address source, instant now,
                              duration far_slack) {
  if (early_.size() < config_.early_max) {
    early_.push_back({handle, source, std::nullopt, now + patience(far_slack)});
    return {};
  }
  ++counters_.refused;
  return {disconnect{handle}};
}

outputs channels::on_channel_closed(channel_handle handle) {
  outputs todo;
  std::erase_if(early_, [&](const early& x) { return x.channel == handle; });
  if (auto* x = find(handle)) {
    x->channel.reset();
    if (is_opening(*x))
      drop(x->id, todo);
    else
      end(*x, todo);
  }
  return todo;
}

outputs channels::on_channel_octets(channel_handle handle, byte_view octets) {
  outputs todo;
  const auto content = decode_message(octets);
  if (!content) {
    ++counters_.malformed;
    return todo;
  }
  if (auto* x = find(handle)) {
    if (x->is_out)
      on_out_message(*x, *content, todo);
    else
      on_in_message(*x, *content, todo);
    return todo;
  }
  const auto found = std::find_if(early_.begin(), early_.end(),
                                  [&](const early& x) { return x.channel == handle; });
  const auto* request = std::get_if<open_message>(&*content);
  if (found == early_.end() || request == nullptr) {
    ++counters_.strays;
    return todo;
  }
  auto x = *found;
  early_.erase(found);
  x.request = *request;
  on_open(x, todo);
  return todo;
}

/// SYN_OPEN over a channel that is not in use yet; it gets no answer before the in end is created.
/// A node that opens anew has lost its old channel, which we may not know yet.
void channels::on_open(const early& x, outputs& todo) {
  const auto is_rival = [&](const early& y) { return y.request && y.source == x.source; };
  if (const auto rival = std::find_if(early_.begin(), early_.end(), is_rival);
      rival != early_.end()) {
    todo.emplace_back(disconnect{rival->channel});
    early_.erase(rival);
  }
  auto* reader = find(false, x.source);
  if (reader != nullptr && reader->loops) { // somebody has our address
    ++counters_.refused;
    todo.emplace_back(disconnect{x.channel});
    return;
  }
  if (reader != nullptr && reader->at == phase::open) {
    end(*reader, todo);
    reader = nullptr;
  }
  if (reader == nullptr) {
    early_.push_back(x);
    return;
  }
  reader->channel = x.channel;
  if (reader->shape == *x.request) {
    todo.emplace_back(send_on_channel{x.channel, encode(open_ack_message{})});
    opened(*reader, todo);
  } else {
    todo.emplace_back(send_on_channel{x.channel, encode(open_nak_message{})});
    drop(reader->id, todo);
  }
}

void channels::on_out_message(row& x, const message& content, outputs& todo) {
  const auto* stopped = std::get_if<stop_ack_message>(&content);
  if (std::holds_alternative<open_ack_message>(content)) {
    if (x.at == phase::asking)
      opened(x, todo);
  } else if (std::holds_alternative<open_nak_message>(content) && x.at == phase::asking) {
    drop(x.id, todo);
  } else if (stopped != nullptr && x.last_tick == stopped->tick) {
    x.stops_left = 0;
  } else {
    ++counters_.strays;
  }
}

void channels::on_in_message(row& x, const message& content, outputs& todo) {
  const auto* open = std::get_if<open_message>(&content);
  const auto* stopped = std::get_if<stop_message>(&content);
  if (const auto* vector = std::get_if<vector_message>(&content)) {
    on_vector(x, *vector);
  } else if (stopped != nullptr) {
    x.input.stop(stopped->tick, tick_);
    todo.emplace_back(send_on_channel{*x.channel, encode(stop_ack_message{stopped->tick})});
  } else if (open != nullptr && *open == x.shape) {
    todo.emplace_back(send_on_channel{*x.channel, encode(open_ack_message{})});
  } else {
    ++counters_.strays;
  }
}

void channels::on_vector(row& x, const vector_message& content) {
  if (content.first + content.values.size() > x.shape.size) {
    ++counters_.malformed;
    return;
  }
  switch (x.input.put(content, tick_)) {
  case arrivals::verdict::taken:
    return;
  case arrivals::verdict::repeated:
    ++counters_.repeated;
    return;
  case arrivals::verdict::late:
    ++counters_.late;
    return;
  case arrivals::verdict::untimely:
    ++counters_.untimely;
    return;
  }
}

} // namespace rubicon::synaptic
