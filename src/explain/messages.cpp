#include "explain/messages.hpp"

#include "network/am.hpp"
#include "stream/message.hpp"
#include "synaptic/message.hpp"
#include "traffic/packet.hpp"
#include "traffic/program.hpp"
#include "transport/segment.hpp"
#include "transport/tunnel_message.hpp"

namespace rubicon::explain {

namespace {

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

} // namespace

/// @param number of which it is the effect: what that causes belongs to this message
std::uint32_t message_follower::begin(message x, std::uint64_t number, const record& r) {
  const auto index = static_cast<std::uint32_t>(all_.all.messages.size());
  const auto parent = all_.step_of(number);
  x.name = all_.all.known.of(x.source) + '#' + std::to_string(++numbers_[x.source]);
  node root;
  root.what = step::sends;
  root.about = {false, index};
  root.from = x.program.empty() ? all_.all.known.path_of(x.source) : x.program;
  root.begin = r.time;
  root.arrived = r.time;
  all_.all.messages.push_back(std::move(x));
  const auto n = all_.add(std::move(root), parent);
  all_.all.messages[index].root = n;
  all_.all.messages[index].is_accounted = accounted_.erase(number) > 0;
  all_.stands_for(number, n);
  return index;
}

void message_follower::on_begun(const record& r) {
  const bool is_on_channel = r.text == "channel";
  const bool is_in_tunnel = r.text == "tunnel";
  if (r.text == "message" && r.id != 0)
    subscribers_[r.number] = mote_id(static_cast<std::uint16_t>(r.id));
  else if (r.text == "message" || is_on_channel || is_in_tunnel)
    accounted_.insert(r.number);
  const auto source = all_.all.known.address_of(r.from);
  if (!source || !(is_on_channel || is_in_tunnel))
    return;
  message x; // it may be lost before anything of it is seen
  x.source = *source;
  x.destination = {source->island, mote_id{}};
  x.is_on_channel = is_on_channel;
  x.is_in_tunnel = is_in_tunnel;
  begin(std::move(x), r.number, r);
}

void message_follower::on_ended(const record& r) {
  accounted_.erase(r.id);
  const auto n = all_.own_step_of(r.id);
  if (all_.is_about_message(n))
    all_.all.messages[all_.at(n).about.index].ending = {r.time, r.yes, r.text, r.from};
}

void message_follower::on_send(const record& r) {
  const auto self = all_.all.known.address_of(r.to);
  if (!self)
    return;
  message x;
  x.source = *self;
  x.destination = resolved(r.mote, *self);
  x.channel = r.channel;
  x.is_reliable = r.yes;
  x.content = r.octets;
  x.program = r.from;
  if (x.destination == *self) // by no medium
    x.delivered = r.time;
  const auto begun = all_.begun(r.cause, "message");
  unended_[{r.from, r.id}] = begin(std::move(x), begun != 0 ? begun : r.number, r);
}

void message_follower::on_message(const record& r) {
  const auto parent = all_.step_of(r.cause);
  if (!all_.is_about_message(parent))
    return;
  node x;
  x.what = step::receives;
  x.about = all_.at(parent).about;
  x.from = r.to;
  x.begin = r.time;
  x.arrived = r.time;
  all_.stands_for(r.number != 0 ? r.number : r.cause, all_.add(std::move(x), parent));
}

void message_follower::on_send_ended(const record& r) {
  const auto open = unended_.extract({r.to, r.id});
  if (open.empty())
    return;
  const auto index = open.mapped();
  auto& m = all_.all.messages[index];
  m.refused = r.text == "refused";
  if (m.refused)
    m.delivered.reset();
  if (!m.refused && !m.is_reliable)
    return;
  if (!r.yes)
    m.failed = r.time;
  node x;
  x.what = step::learns;
  x.about = {false, index};
  x.from = r.to;
  x.begin = r.time;
  x.arrived = r.time;
  x.text = m.refused ? "refused" : r.yes ? "acknowledged" : "failed";
  auto parent = all_.step_of(r.cause);
  if (parent == no_node || all_.at(parent).about != subject{false, index})
    parent = m.root;
  all_.add(std::move(x), parent);
}

// ------------------------------------------------------------------------------- which one is it?

std::optional<sighting> message_follower::recognise(const carried_fragment& x, std::uint64_t cause,
                                                    island_id here, const record& r) {
  if (x.part.index > 0)
    return recognise_rest(cause);
  const auto packet = envelope_of(x.part.content, x.is_down, here);
  return packet ? recognise(*packet, cause, r) : std::nullopt;
}

std::optional<sighting> message_follower::recognise_rest(std::uint64_t cause) const {
  const auto n = all_.step_of(cause);
  return all_.is_about_message(n) ? std::optional(sighting{all_.at(n).about}) : std::nullopt;
}

std::optional<sighting> message_follower::recognise(const envelope& x, std::uint64_t cause,
                                                    const record& r) {
  using says = transport::segment::kind;
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
    return seen(std::move(m), cause, r);
  }
  auto segment = transport::decode_segment(x.body);
  if (!segment)
    return std::nullopt;
  m.source.mote = segment->source;
  m.channel = segment->am_type;
  m.is_reliable = segment->what != says::plain;
  if (segment->what != says::hello)
    m.content = std::move(segment->payload);
  switch (segment->what) {
  case says::plain:
  case says::reliable:
    return seen(std::move(m), cause, r);
  case says::hello: {
    auto what = seen(std::move(m), cause, r);
    what->of = cargo::greeting;
    return what;
  }
  case says::acknowledgement:
    return answered(cargo::answer, "acknowledgement", false, cause);
  case says::busy:
    return answered(cargo::answer, "answer: busy", true, cause);
  case says::refused:
    return answered(cargo::answer, "answer: refused", true, cause);
  case says::no_program:
    return answered(cargo::answer, "answer: no program", true, cause);
  }
  return std::nullopt;
}

/// A message in transit, or one that nobody here has begun.
std::optional<sighting> message_follower::seen(message x, std::uint64_t cause, const record& r) {
  const auto begun = all_.begun(cause, "message");
  const auto n = all_.step_of(cause);
  if (begun == 0 && all_.is_about_message(n)) {
    auto& known = all_.all.messages[all_.at(n).about.index];
    if (!known.content && known.is_on_channel == x.is_on_channel &&
        known.is_in_tunnel == x.is_in_tunnel) {
      known.content = std::move(x.content);
      known.channel = x.channel;
      known.destination = x.destination;
    }
    return sighting{all_.at(n).about};
  }
  return sighting{{false, begin(std::move(x), begun != 0 ? begun : r.number, r)}};
}

/// It answers what has come with its cause. @param turned_away the receiver has not taken it
std::optional<sighting> message_follower::answered(cargo of, const char* kind, bool turned_away,
                                                   std::uint64_t cause) {
  auto n = all_.step_of(cause);
  while (n != no_node && all_.at(n).what != step::hop)
    n = all_.at(n).parent;
  if (!all_.is_about_message(n))
    return std::nullopt;
  const auto about = all_.at(n).about;
  auto& m = all_.all.messages[about.index];
  const auto asked = all_.at(n).of;
  if (asked == cargo::greeting || asked == cargo::greeting_answer)
    return sighting{about, cargo::greeting_answer, kind};
  if (turned_away && !m.acknowledged) {
    m.delivered.reset();
    m.turned_away = true;
  }
  return sighting{about, of, kind};
}

std::optional<sighting> message_follower::recognise(const channel_content& x, island_id here,
                                                    const record& r) {
  const auto n = all_.step_of(r.cause);
  const bool is_known =
      all_.is_about_message(n) && all_.all.messages[all_.at(n).about.index].is_on_channel;
  if (!is_known && !is_stream_record(x.content))
    return std::nullopt;
  message m;
  m.source = all_.all.known.address_of(r.from).value_or(mote_address{here, no_mote});
  m.destination = {here, mote_id{}};
  m.channel = static_cast<std::uint16_t>(x.channel & 0xffffU);
  m.content = x.content;
  m.is_on_channel = true;
  return seen(std::move(m), r.cause, r);
}

std::optional<sighting> message_follower::recognise_event(island_id here, const record& r) {
  const auto subscriber = subscribers_.find(all_.begun(r.cause, "message"));
  if (subscriber == subscribers_.end())
    return recognise_rest(r.cause);
  message m;
  m.source = all_.all.known.address_of(r.from).value_or(mote_address{here, no_mote});
  m.destination = {here, subscriber->second};
  m.channel = network::am::smepp;
  return sighting{{false, begin(std::move(m), subscriber->first, r)}};
}

std::optional<sighting> message_follower::recognise_flow(byte_view octets, island_id here,
                                                         const record& r) {
  const auto packet = traffic::decode_packet(octets);
  if (!packet)
    return std::nullopt;
  const std::tuple key(here, packet->origin, packet->number);
  auto known = measuring_.find(key);
  if (known == measuring_.end()) {
    message m;
    m.source = {here, packet->origin};
    m.destination = {here, packet->target};
    m.channel = traffic::am_type;
    m.content = to_bytes(octets);
    known = measuring_.emplace(key, begin(std::move(m), r.number, r)).first;
  }
  return sighting{{false, known->second}};
}

} // namespace rubicon::explain
