// The part of the builder that tells messages apart and knows when they are there.
#include <algorithm>

#include "explain/builder.hpp"
#include "flow/packet.hpp"
#include "flow/program.hpp"
#include "stream/message.hpp"
#include "synaptic/message.hpp"
#include "transport/tunnel_message.hpp"

namespace rubicon::explain {

namespace {

using transport::segment;

/// Counters and sequences begin anew some day: who has not been seen for so long is another one.
constexpr duration session_memory = 10min;
constexpr duration packet_memory = 60s;
constexpr duration channel_memory = 5s;

bool begins_with(const bytes& whole, const bytes& part) {
  return whole.size() >= part.size() && std::equal(part.begin(), part.end(), whole.begin());
}

/// What a program means by an address, on the mote or PC where it runs.
mote_address resolved(mote_address x, mote_address self) {
  if (x.island == own_island)
    x.island = self.island;
  if (x.mote == own_mote)
    x.mote = self.mote;
  return x;
}

bool is_stream_record(byte_view octets) {
  if (const auto x = synaptic::decode_message(octets))
    return std::holds_alternative<synaptic::vector_message>(*x);
  const auto x = stream::decode_message(octets);
  return x && std::holds_alternative<stream::write_message>(*x);
}

/// What a program does in its mote's actor is no delivery, but part of one.
std::uint64_t delivery_of(const record& r) {
  return r.number != 0 ? r.number : r.cause;
}

} // namespace

std::uint32_t builder::begin_message(message x, const record& r) {
  const auto index = static_cast<std::uint32_t>(all_.messages.size());
  x.name = all_.known.of(x.source) + '#' + std::to_string(++numbers_[x.source]);
  node root;
  root.what = step::sends;
  root.about = {false, index};
  root.from = x.program.empty() ? all_.known.path_of(x.source) : x.program;
  root.begin = r.time;
  root.arrived = r.time;
  all_.messages.push_back(std::move(x));
  const auto n = add(std::move(root), caused(r.cause));
  all_.messages[index].root = n;
  return index;
}

// ------------------------------------------------------------------------------ programs of motes

void builder::on_send(const record& r) {
  const auto self = all_.known.address_of(r.to);
  if (!self)
    return;
  message x;
  x.source = *self;
  x.destination = resolved(r.mote, *self);
  x.channel = r.channel;
  x.is_reliable = r.yes;
  x.content = r.octets;
  x.program = r.from;
  const auto destination = x.destination;
  const auto index = begin_message(std::move(x), r);
  waiting_[{*self, destination}].push_back(index);
  sent_by_[delivery_of(r)].push_back(index);
  unended_[{r.from, r.id}].push_back(index);
}

void builder::on_message(const record& r) {
  const auto parent = caused(r.cause);
  if (parent == no_node || at(parent).about.is_tuple)
    return;
  node x;
  x.what = step::receives;
  x.about = at(parent).about;
  x.from = r.to;
  x.begin = r.time;
  x.arrived = r.time;
  arrivals_[delivery_of(r)].push_back(add(std::move(x), parent));
}

void builder::on_send_ended(const record& r) {
  const auto open = unended_.find({r.to, r.id});
  if (open == unended_.end() || open->second.empty())
    return;
  const auto index = open->second.front();
  open->second.pop_front();
  auto& m = all_.messages[index];
  m.refused = r.text == "refused";
  if (!m.refused && !m.is_reliable)
    return;
  if (!r.yes) {
    m.failed = r.time;
    std::erase(waiting_[{m.source, m.destination}], index);
  }
  node x;
  x.what = step::learns;
  x.about = {false, index};
  x.from = r.to;
  x.begin = r.time;
  x.arrived = r.time;
  x.text = m.refused ? "refused" : r.yes ? "acknowledged" : "failed";
  auto parent = caused(r.cause);
  if (parent == no_node || at(parent).about != subject{false, index})
    parent = m.root;
  add(std::move(x), parent);
}

// ------------------------------------------------------------------------------- which one is it?

/// The pieces of a packet, or the same packet passed on, are known by what was seen first.
std::optional<builder::sighting> builder::recognise(const carried_piece& x, medium over,
                                                    island_id here, const record& r) {
  if (x.sequence == 0)
    return recognise_packet(x, over, here, r);
  auto& known = packets_[{here, over, x.is_down, x.origin, x.sequence}];
  if (known.what && now_ - known.seen < packet_memory) {
    known.seen = now_;
    return known.what;
  }
  known.what = recognise_packet(x, over, here, r);
  known.seen = now_;
  return known.what;
}

std::optional<builder::sighting> builder::recognise_packet(const carried_piece& x, medium over,
                                                           island_id here, const record& r) {
  const auto& part = x.part;
  if (part.last == 0) {
    const auto packet = envelope_of(part.content, x.is_down, here);
    return packet ? recognise(*packet, r) : std::nullopt;
  }
  constexpr std::uint32_t not_a_sequence = 1U << 31U;
  auto& known = packets_[{here, over, x.is_down, x.origin, not_a_sequence | part.tag}];
  if (known.pieces.size() != part.last + 1U || now_ - known.seen >= packet_memory)
    known = {std::nullopt, std::vector<std::optional<bytes>>(part.last + 1U), now_};
  known.seen = now_;
  if (part.index == 0) {
    if (const auto packet = envelope_of(part.content, x.is_down, here))
      known.what = recognise(*packet, r);
  }
  known.pieces[part.index] = part.content;
  const auto has = [](const auto& y) { return y.has_value(); };
  if (known.what && std::ranges::all_of(known.pieces, has)) {
    bytes whole;
    for (const auto& y : known.pieces)
      whole.insert(whole.end(), y->begin(), y->end());
    if (const auto packet = envelope_of(whole, x.is_down, here))
      complete(*known.what, packet->body);
  }
  return known.what;
}

/// The pieces of the first packet with a message are all there.
void builder::complete(const sighting& what, byte_view body) {
  auto& m = all_.messages[what.about.index];
  const auto x = transport::decode_segment(body);
  if (what.of == cargo::content && x && m.channel <= 0xff &&
      (!m.content || m.content->size() < x->payload.size()))
    m.content = x->payload;
}

std::optional<builder::sighting> builder::recognise(const envelope& x, const record& r) {
  message m;
  m.source = x.source;
  m.destination = x.destination;
  m.channel = x.channel;
  if (x.channel > 0xff) {
    const auto inner = transport::decode_tunnel_message(x.body);
    if (!inner || inner->what != transport::tunnel_message::kind::data)
      return std::nullopt;
    m.source.mote = inner->sender;
    m.content = x.body;
    m.is_in_tunnel = true;
    return recognise_plain(std::move(m), r);
  }
  auto segment = transport::decode_segment(x.body);
  if (!segment)
    return std::nullopt;
  m.source.mote = segment->source;
  m.channel = segment->am_type;
  m.content = std::move(segment->payload);
  if (segment->what == segment::kind::plain)
    return recognise_plain(std::move(m), r);
  return recognise_segment(std::move(m), *segment, r);
}

/// Of those that a program has sent and that have not been seen yet, the one that has just been
/// sent, or else the oldest that fits.
std::optional<std::uint32_t> builder::take_waiting(const message& x, const record& r) {
  auto& waiting = waiting_[{x.source, x.destination}];
  const auto fits = [&](std::uint32_t index) {
    const auto& y = all_.messages[index];
    return y.channel == x.channel && y.is_reliable == x.is_reliable &&
           (!y.content || begins_with(*y.content, *x.content));
  };
  auto found = std::ranges::find_if(waiting, fits);
  if (found == waiting.end())
    return std::nullopt;
  if (const auto sent = sent_by_.find(r.cause); sent != sent_by_.end()) {
    const auto just_now = std::ranges::find_if(waiting, [&](std::uint32_t index) {
      return std::ranges::find(sent->second, index) != sent->second.end() && fits(index);
    });
    if (just_now != waiting.end())
      found = just_now;
  }
  const auto index = *found;
  waiting.erase(found);
  auto& m = all_.messages[index];
  if (!m.content)
    m.content = x.content;
  return index;
}

/// Unreliable messages have no number. Those of equal content are told apart by what led to what,
/// and by where they have been.
std::optional<builder::sighting> builder::recognise_plain(message x, const record& r) {
  auto& like = plain_[{x.source, x.destination, x.channel, *x.content}];
  constexpr std::size_t like_max = 64; // those before are there, or lost
  if (like.size() > like_max)
    like.erase(like.begin(), like.end() - like_max / 2);
  if (const auto before = arrivals_.find(r.cause); before != arrivals_.end()) {
    for (const auto n : before->second)
      if (const auto about = at(n).about;
          !about.is_tuple && std::ranges::find(like, about.index) != like.end())
        return sighting{about};
  }
  if (all_.known.place_of(all_.known.path_of(x.source)) == all_.known.place_of(r.from)) {
    if (const auto sent = take_waiting(x, r)) {
      like.push_back(*sent);
      return sighting{{false, *sent}};
    }
  }
  const bool is_package = r.what == kind::link_octets || r.what == kind::link_lost;
  for (const auto index : like) { // a kernel may have kept it until it knew a way
    const auto& m = all_.messages[index];
    if (is_package && m.nodes.size() == 1 &&
        all_.known.place_of(at(m.root).from) == all_.known.place_of(r.from))
      return sighting{{false, index}};
  }
  for (const auto index : like) {
    const auto here = last_at({false, index}, r.from, cargo::content);
    if (here != no_node && at(here).children.empty())
      return sighting{{false, index}};
  }
  const auto index = begin_message(std::move(x), r);
  like.push_back(index);
  return sighting{{false, index}};
}

std::optional<builder::sighting> builder::recognise_segment(message x, const segment& segment,
                                                            const record& r) {
  const auto known = [&](auto& in, const session_key& key) -> session_entry* {
    const auto entry = in.find(key);
    if (entry == in.end() || now_ - entry->second.seen >= session_memory)
      return nullptr;
    entry->second.seen = now_;
    return &entry->second;
  };
  const bool is_question =
      segment.what == segment::kind::reliable || segment.what == segment::kind::hello;
  if (!is_question) {
    const session_key asked{x.destination, x.source, segment.sender, segment.counter};
    const auto* kind = segment.what == segment::kind::acknowledgement ? "acknowledgement"
                       : segment.what == segment::kind::busy          ? "answer: busy"
                                                                      : "answer: refused";
    if (const auto* entry = known(sessions_, asked)) {
      if (segment.what != segment::kind::acknowledgement)
        turn_away(entry->message, segment.what == segment::kind::refused);
      return sighting{{false, entry->message}, cargo::answer, kind};
    }
    if (const auto* entry = known(greetings_, asked))
      return sighting{{false, entry->message}, cargo::greeting_answer, kind};
    return std::nullopt;
  }
  const session_key key{x.source, x.destination, segment.sender, segment.counter};
  x.is_reliable = true;
  if (segment.what == segment::kind::hello) {
    if (const auto* entry = known(greetings_, key))
      return sighting{{false, entry->message}, cargo::greeting, ""};
    auto& waiting = waiting_[{x.source, x.destination}];
    const auto fits = [&](std::uint32_t index) {
      return all_.messages[index].is_reliable && all_.messages[index].channel == x.channel;
    };
    const auto first = std::ranges::find_if(waiting, fits);
    std::uint32_t index = 0;
    if (first != waiting.end()) {
      index = *first;
    } else {
      x.content.reset();
      index = begin_message(std::move(x), r);
      waiting.push_back(index);
    }
    greetings_[key] = {index, now_};
    return sighting{{false, index}, cargo::greeting, ""};
  }
  if (const auto* entry = known(sessions_, key))
    return sighting{{false, entry->message}};
  const auto sent = take_waiting(x, r);
  const auto index = sent ? *sent : begin_message(std::move(x), r);
  sessions_[key] = {index, now_};
  return sighting{{false, index}};
}

/// The receiver has not taken it. @param for_good it is not to come again with this number
void builder::turn_away(std::uint32_t index, bool for_good) {
  auto& m = all_.messages[index];
  if (m.acknowledged)
    return;
  m.delivered.reset();
  m.turned_away = true;
  auto& waiting = waiting_[{m.source, m.destination}];
  if (for_good && !m.failed && std::ranges::find(waiting, index) == waiting.end())
    waiting.push_front(index);
}

std::optional<builder::sighting> builder::recognise_channel(const channel_content& x,
                                                            island_id here, const record& r) {
  if (!is_stream_record(x.content))
    return std::nullopt;
  auto& entry = on_channels_[{here, x.channel, x.sequence, x.content}];
  if (entry.seen == instant{} || now_ - entry.seen >= channel_memory) {
    message m;
    m.source = all_.known.address_of(r.from).value_or(mote_address{here, no_mote});
    m.destination = {here, mote_id{}};
    m.channel = static_cast<std::uint16_t>(x.channel & 0xffffU);
    m.content = x.content;
    m.is_on_channel = true;
    entry.message = begin_message(std::move(m), r);
  }
  entry.seen = now_;
  return sighting{{false, entry.message}};
}

/// Packets of the measuring apps have a number.
std::optional<builder::sighting> builder::recognise_flow(byte_view octets, island_id here,
                                                         const record& r) {
  const auto packet = flow::decode_packet(octets);
  if (!packet)
    return std::nullopt;
  const std::tuple key(here, packet->origin, packet->number);
  auto known = measuring_.find(key);
  if (known == measuring_.end()) {
    message m;
    m.source = {here, packet->origin};
    m.destination = {here, packet->target};
    m.channel = flow::am_type;
    m.content = to_bytes(octets);
    known = measuring_.emplace(key, begin_message(std::move(m), r)).first;
  }
  return sighting{{false, known->second}};
}

/// A hop of a message has reached somebody: is it at its end?
void builder::deliver(const node& x, const std::string& actor, instant when) {
  if (x.about.is_tuple)
    return;
  auto& m = all_.messages[x.about.index];
  const auto kernel = all_.known.peer_of(actor);
  const auto who =
      kernel ? std::optional(mote_address{
                   island_id(static_cast<std::uint32_t>(all_.known.speaks_for(*kernel).value)),
                   no_mote})
             : all_.known.address_of(actor);
  if (!who)
    return;
  if (x.of == cargo::answer) {
    if (*who == m.source && x.text == "acknowledgement" && !m.acknowledged)
      m.acknowledged = when;
  } else if (x.of == cargo::content) {
    if (m.is_on_channel) // as far as it has come
      m.destination = *who;
    const bool is_there = m.is_on_channel || *who == m.destination ||
                          (m.destination.mote == broadcast_mote &&
                           who->island == m.destination.island && x.heard.size() == 1);
    if (is_there && !m.delivered)
      m.delivered = when;
  }
}

} // namespace rubicon::explain
