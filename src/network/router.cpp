#include "network/router.hpp"

#include <algorithm>
#include <limits>

#include "network/am.hpp"
#include "network/clock/tick_plan.hpp"
#include "network/slot_time.hpp"

namespace rubicon::network {

namespace {

constexpr unsigned purpose_bits = 2;
/// A settled anchor tells of itself every 8 minutes at most: so long the way to it may be broken
/// after a mote in between has restarted. Meanwhile everybody goes by the places that it had.
constexpr duration anchor_patience = 10min;
constexpr duration crowd_beacon = 4s;
/// Who hears a mote that has started beacons soon, where radios sleep in the next window: within
/// this and two periods all have, if some beacons get lost.
constexpr duration neighbours_wait = 1s;
constexpr duration lost_pause = 1s; ///< then it is seen again whether the time is known
constexpr duration reborn_quiet = 200ms;
constexpr duration sleeping_round = 30s; ///< between rounds of the clock where radios sleep

/// Where radios listen at low power, a broadcast occupies the air for a whole interval: beacons are
/// so many of its lengths apart at least.
constexpr int beacon_lengths = 4;

neighbours_config links_of(const router_config& config) {
  neighbours_config x;
  if (config.is_sink)
    x.capacity = 24 + config.backbone.motes.size();
  x.backbone = config.backbone.motes;
  // A beacon a window: links must be known after few. Windows are crowded: a link over which nearly
  // every unicast arrives, which is sent again, may lose half of its beacons.
  if (config.duty.enabled()) {
    x.good_samples = 2;
    x.usable_samples = 2;
    x.unusable_missed = 4;
    x.bad_missed = 5;
    x.good_from = quality_of(0.5);
    x.bad_below = quality_of(0.25);
    x.beacon_slack += config.duty.period;
    x.beacon_gap_max += config.duty.period;
  }
  // Beacons are rare, and each is repeated until all neighbours can have received it.
  if (config.wake > 0s) {
    x.good_samples = 2;
    x.usable_samples = 2;
    x.beacon_slack += 2 * config.wake;
    x.beacon_gap_max += 2 * config.wake;
  }
  return x;
}

/// Others are of no use until they know a route to the sink: it does not keep quiet for them.
trickle_config beacons_of(const router_config& config) {
  auto x = config.beacons;
  if (config.duty.enabled()) {
    x.interval_min = std::clamp(config.duty.period, x.interval_min, x.interval_max);
    x.shortest = 5;
  }
  if (config.wake > 0s) {
    x.interval_min = std::clamp(beacon_lengths * config.wake, x.interval_min, x.interval_max);
    x.shortest = 2;
  }
  if (config.is_sink || !config.backbone.motes.empty())
    x.redundancy = std::numeric_limits<unsigned>::max();
  return x;
}

/// Who sleeps has no better sign of a root that has gone than rounds that do not come.
clock_sync_config clock_of(const router_config& config) {
  clock_sync_config x;
  x.self = config.self;
  x.is_root = config.is_sink;
  x.era = config.era;
  x.tick = config.tick;
  x.resume_wait += config.duty.period + config.duty.length;
  if (config.duty.enabled()) {
    x.period = std::max(sleeping_round, config.duty.period);
    x.stale_after = 3 * x.period;
  }
  if (config.wake > 0s) {
    x.resume_wait += 2 * config.wake;
    x.period_first = std::max(x.period_first, beacon_lengths * config.wake);
    x.period = std::max(x.period, round_lengths * config.wake);
    x.period_least = std::max(x.period_least, round_lengths / 6 * config.wake);
    x.stale_after = 3 * x.period;
  }
  return x;
}

/// A sink that has lived before has motes that know the time.
time_search_config search_of(const own_router_config& config) {
  time_search_config x;
  x.is_root = config.is_sink;
  x.duty = config.duty;
  if (config.is_sink && config.era > 0)
    x.start_quiet = reborn_quiet;
  if (config.wake > 0s) {
    x.start_quiet += beacon_lengths * config.wake;
    x.company = std::max(x.company, beacon_lengths * config.wake);
    x.stale_spread = std::max(x.stale_spread, beacon_lengths * config.wake);
    x.pause = std::max(x.pause, beacon_lengths * config.wake);
    x.pause_max = std::max(x.pause_max, x.pause);
  }
  return x;
}

/// What a router says of itself to all, where each time takes so long.
own_router_config with_patience(own_router_config x) {
  if (x.wake == 0s)
    return x;
  const auto apart = 2 * x.wake;
  for (auto* gap : {&x.change_beacon, &x.help_gap, &x.relay_pause, &x.answer_gap_awake})
    *gap = std::max(*gap, apart);
  x.relay_spread = std::max(x.relay_spread, x.wake);
  x.answer_spread_awake = std::max(x.answer_spread_awake, x.wake);
  x.relays_max = 1; // all neighbours can have received it then
  x.sequence_gap += beacon_lengths * x.wake;
  return x;
}

} // namespace

router::router(router_config config, random_stream rng, instant now)
    : config_(with_patience(config)), rng_(rng), links_(links_of(config)),
      tree_({.self = config.self, .is_root = config.is_sink}),
      place_({.self = config.self, .is_sink = config.is_sink, .anchor_patience = anchor_patience},
             now),
      started_(now), timer_(beacons_of(config), random_stream(rng_.next()), now), reported_(now),
      seek_end_(now + config.seek_length), report_gap_(config.report_gap),
      helped_(now - config.help_gap), answered_(now - config.answer_gap_awake), silent_(now),
      requested_(now - config.period_request_gap) {
  clock_ = clock_sync(clock_of(config), now);
  places_ = config_.is_sink ? place_cache(config_.places_max, 0s)
                            : place_cache(config_.places_kept, config_.place_lifetime);
  auto packets = config.packets;
  packets.self = config_.self;
  packets.is_root = config_.is_sink;
  if (config_.is_sink) { // has a PC's memory and power
    packets.queue_max = std::max<std::size_t>(packets.queue_max, 32);
    packets.octets_max = std::max(packets.octets_max, 32 * frame_payload_max);
    packets.seen_max = 64;
  }
  packets.flood_spread = std::max(packets.flood_spread, config_.wake);
  packets_ = collection(packets, random_stream(rng_.next()));
  auto paths = config.paths;
  paths.self = config_.self;
  if (config_.is_sink) {
    paths.entries_max = std::max<std::size_t>(paths.entries_max, 32);
    paths.offers_max = 12;
    paths.queue_max = std::max<std::size_t>(paths.queue_max, 16);
    paths.octets_max = std::max(paths.octets_max, 16 * channel_packet_max);
  }
  if (config_.duty.enabled()) {
    paths.round_pause = 8ms;   // the next mote waits for a late packet
    paths.data_rounds_max = 4; // the second one waits for a window: then it had better arrive
    paths.flood_spread = std::min(paths.flood_spread, spread_in_window());
    config_.relay_spread = std::min(config_.relay_spread, spread_in_window());
  }
  paths.wake = config_.wake;
  paths.flood_spread = std::max(paths.flood_spread, config_.wake);
  paths_ = channels(paths, random_stream(rng_.next()));
  auto further = rng_; // the others draw as they do without turns
  search_ = time_search(search_of(config_), random_stream(further.next()), now);
  turns_ = turns(config_.is_sink, config_.duty, random_stream(further.next()));
}

/// What goes to everybody is to take several hops in a window.
duration router::spread_in_window() const {
  return config_.duty.length / 8;
}

duration router::change_beacon() const {
  return std::max(config_.change_beacon, config_.duty.period);
}

void router::use_slots(std::size_t count, instant now) {
  const tick_plan plan(clock_.time().tick(now).value_or(config_.tick).period);
  clock_.use_slots(plan.share_of(count), now);
}

/// For what is sent from now on.
void router::keep_turns(instant now) {
  const auto next = turns_.next(now, clock_.time());
  turn_ = next > now ? next : instant{};
  // Who does not know when its neighbours listen keeps what it has for them, but for beacons.
  const bool is_lost = config_.duty.enabled() && !config_.duty.knows_time(now, clock_.time());
  const auto held = is_lost ? now + lost_pause : turn_;
  packets_.hold(held);
  paths_.hold(held);
}

bool router::owns(std::uint8_t am_type) {
  return am_type == am::local || (am_type >= am::beacon && am_type <= am::channel);
}

frame_out router::frame_for(purpose why, mote_id to, std::uint8_t am_type, bytes payload) {
  const auto token = frames_++ << purpose_bits | static_cast<std::uint64_t>(why);
  return {token, to, am_type, std::move(payload), std::nullopt};
}

/// What is sent to all also goes over each backbone, as a copy that nobody acknowledges.
void router::emit(frame_out x, router_outputs& out) const {
  if (x.next_hop != broadcast_mote) {
    x.over = links_.has_backbone(x.next_hop) ? medium::backbone : medium::radio;
    out.emplace_back(std::move(x));
    return;
  }
  for (const auto end : config_.backbone.motes) {
    frame_out copy{no_token, end, x.am_type, x.payload, std::nullopt};
    copy.over = medium::backbone;
    out.emplace_back(std::move(copy));
  }
  out.emplace_back(std::move(x));
}

// Content.

std::optional<std::size_t> router::room_to(mote_id destination) const {
  if (!config_.is_sink)
    return collection::room_up() - 1;
  const auto room = packets_.room_down(destination);
  return room ? std::optional(*room - 1) : std::nullopt;
}

std::size_t router::room_to_all() {
  return collection::room_flood() - 1;
}

router_outputs router::send(mote_id destination, bytes content, instant now, bool in_slot) {
  router_outputs out;
  keep_turns(now);
  const bool is_near = destination != tree_.root() && links_.good(destination) &&
                       directs_.size() < config_.direct_max;
  if (config_.is_sink || !is_near) {
    send_router_message(destination, user_content{std::move(content)}, out, now, in_slot);
    return out;
  }
  auto frame = frame_for(purpose::direct, destination, am::local, content);
  directs_[frame.token] = {destination, std::move(content)};
  waiting_directs_.push_back(std::move(frame));
  send_directs(out, now);
  return out;
}

void router::send_directs(router_outputs& out, instant now) {
  if (turn_ > now)
    return;
  for (auto& x : std::exchange(waiting_directs_, {})) {
    handed_[x.token] = x.next_hop;
    emit(std::move(x), out);
  }
}

router_outputs router::send_to_all(bytes content, instant now) {
  router_outputs out;
  keep_turns(now);
  take(packets_.send_to_all(encode(user_content{std::move(content)}), now), out, now);
  return out;
}

/// Up, or from the sink down.
void router::send_router_message(mote_id to, const router_message& x, router_outputs& out,
                                 instant now, bool in_slot) {
  if (!config_.is_sink)
    told_parent_ = tree_.parent(); // the header says it
  take(config_.is_sink ? packets_.send_down(to, encode(x), now)
                       : packets_.send_up(encode(x), now, in_slot),
       out, now);
}

void router::take(collection_outputs todo, router_outputs& out, instant now) {
  for (auto& x : todo) {
    if (auto* packet = std::get_if<collected>(&x)) {
      on_content(std::move(*packet), out, now);
      continue;
    }
    auto& next = std::get<hop>(x);
    const acting_on its(next.from);
    auto frame = frame_for(purpose::packet, next.next, next.am_type, std::move(next.octets));
    frame.in_slot = next.in_slot;
    if (next.next != broadcast_mote)
      handed_[frame.token] = next.next;
    emit(std::move(frame), out);
  }
  if (packets_.take_loop_seen())
    hurry(now);
}

void router::on_content(collected x, router_outputs& out, instant now) {
  auto message = decode_router_message(x.content);
  if (!message) {
    ++counters_.malformed;
    return;
  }
  const auto origin = x.by_flood || config_.is_sink ? std::optional(x.origin) : std::nullopt;
  if (auto* content = std::get_if<user_content>(&*message)) {
    out.emplace_back(content_in{origin, x.by_flood, std::move(content->content)});
  } else if (const auto* report = std::get_if<place_report>(&*message)) {
    if (report->place && config_.is_sink)
      learn_place(x.origin, *report->place, now);
  } else if (std::holds_alternative<sequence_request>(*message)) {
    if (config_.is_sink && may_hasten(now)) {
      tree_.hasten();
      beacon_due_ = true;
    }
  } else if (const auto* wanted = std::get_if<period_request>(&*message)) {
    if (config_.is_sink)
      clock_.request_period(wanted->period, now);
  } else if (const auto* asked = std::get_if<place_question>(&*message)) {
    if (config_.is_sink)
      send_router_message(x.origin, place_answer{asked->mote, known_place(asked->mote, now)}, out,
                          now);
  } else {
    const auto& answer = std::get<place_answer>(*message);
    if (answer.place)
      learn_place(answer.mote, *answer.place, now);
    for (auto q = questions_.begin(); q != questions_.end();) {
      if (q->destination != answer.mote) {
        ++q;
        continue;
      }
      if (links_.is_full() && may_ask_again(*q) && (!answer.place || !place_.place())) {
        q->due = now + config_.question_gap;
        ++q;
        continue;
      }
      const auto settled = *q;
      q = questions_.erase(q);
      begin(settled, answer.place ? answer.place : places_.find_old(answer.mote), out, now);
    }
  }
}

std::optional<virtual_coordinates> router::known_place(mote_id x, instant now) const {
  if (x == config_.self)
    return place_.likely_place();
  const auto found = places_.find(x, now);
  return found ? found : place_.likely_place_of(x);
}

void router::learn_place(mote_id x, virtual_coordinates place, instant now) {
  if (x != config_.self)
    places_.learn(x, place, now);
}

/// Places in messages of others that pass: a mote's report to the sink, the sink's answer to a
/// mote, and where a channel is to lead. Most packets are none of these: their content is not
/// decoded.
void router::learn_from(std::uint8_t am_type, byte_view payload, instant now) {
  if (am_type == am::channel) {
    const auto x = decode_channel_message(payload);
    const auto* wish = x ? std::get_if<connect_message>(&x->content) : nullptr;
    if (wish != nullptr && wish->place)
      learn_place(wish->destination, *wish->place, now);
  } else if (am_type == am::up) {
    constexpr auto kind_at = up_packet::header_size;
    if (payload.size() <= kind_at || payload[kind_at] != router_message(place_report{}).index())
      return;
    const auto x = decode_up(payload);
    const auto message = x ? decode_router_message(x->content) : errc::truncated;
    const auto* report = message ? std::get_if<place_report>(&*message) : nullptr;
    if (report != nullptr && report->place)
      learn_place(x->origin, *report->place, now);
  } else if (am_type == am::down) {
    const auto x = decode_down(payload);
    const auto message = x ? decode_router_message(x->content) : errc::truncated;
    const auto* answer = message ? std::get_if<place_answer>(&*message) : nullptr;
    if (answer != nullptr && answer->place)
      learn_place(answer->mote, *answer->place, now);
  }
}

// Channels.

std::pair<channel_id, router_outputs> router::connect(mote_id destination,
                                                      const channel_schedule& schedule,
                                                      duration expiry, instant now) {
  router_outputs out;
  keep_turns(now);
  const question x{paths_.next_id(), destination, schedule, expiry, now + answer_wait(now)};
  auto place = known_place(destination, now);
  const bool must_ask = !config_.is_sink && !place && !links_.good(destination) &&
                        questions_.size() < config_.questions_max;
  if (!place)
    place = places_.find_old(destination);
  if (must_ask && (has_route() || !place)) {
    questions_.push_back(x);
    if (has_route())
      ask(questions_.back(), out, now);
  } else {
    begin(x, place, out, now);
  }
  return {x.channel, std::move(out)};
}

bool router::may_ask_again(const question& x) const {
  return x.asks > 0 && x.asks < (links_.is_full() ? config_.asks_in_crowd_max : config_.asks_max);
}

duration router::answer_wait(instant now) const {
  return config_.question_timeout + (4 + tree_.hops() / 2) * turn_wait(now); // several hops a turn
}

void router::ask(question& x, router_outputs& out, instant now) {
  ++counters_.questions;
  ++x.asks;
  x.due = now + answer_wait(now);
  send_router_message(tree_.root(), place_question{x.destination}, out, now);
}

void router::begin(const question& x, std::optional<virtual_coordinates> place, router_outputs& out,
                   instant now) {
  take(paths_.connect(x.channel, x.destination, place, x.schedule, x.expiry, around(now), now),
       out);
}

std::optional<router_outputs> router::send_on(channel_id channel, bytes content, departure how,
                                              instant now) {
  keep_turns(now);
  auto todo = paths_.send(channel, std::move(content), how, now);
  if (!todo)
    return std::nullopt;
  router_outputs out;
  take(*std::move(todo), out);
  return out;
}

router_outputs router::disconnect(channel_id channel, instant now) {
  router_outputs out;
  keep_turns(now);
  std::erase_if(questions_, [channel](const question& x) { return x.channel == channel; });
  take(paths_.disconnect(channel, now), out);
  return out;
}

router_outputs router::refuse(channel_id channel, instant now) {
  router_outputs out;
  keep_turns(now);
  take(paths_.refuse(channel, now), out);
  return out;
}

surroundings router::around(instant now) const {
  surroundings x;
  x.own_place = place_.presumed_place();
  x.is_crowd = links_.is_full();
  x.turn_wait = turn_wait(now);
  x.beacon_wait = neighbours_wait + 2 * config_.duty.period + 2 * beacon_lengths * config_.wake;
  x.is_new = now - started_ < 2 * x.beacon_wait;
  x.parent = tree_.has_route() ? tree_.parent() : no_mote;
  for (const auto& each : links_.all()) {
    if (each.good)
      x.motes.push_back({each.mote, place_.likely_place_of(each.mote)});
    else
      x.heard.push_back({each.mote, place_.likely_place_of(each.mote)});
  }
  return x;
}

void router::take(channels_outputs todo, router_outputs& out) {
  for (auto& x : todo) {
    if (auto* next = std::get_if<channel_hop>(&x)) {
      const acting_on its(next->from);
      auto frame = frame_for(purpose::channel, next->next, am::channel, std::move(next->octets));
      frame.in_slot = next->in_slot;
      if (next->next != broadcast_mote)
        handed_[frame.token] = next->next;
      emit(std::move(frame), out);
      continue;
    }
    std::visit(
        [&out](auto& y) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(y)>, channel_hop>)
            out.emplace_back(std::move(y));
        },
        x);
  }
}

// Beacons.

void router::send_beacon(router_outputs& out, instant now, bool again, bool asks) {
  again = again && beacon_sequence_ > 0;                 // the first one has a number to count
  const bool is_extra = again && config_.duty.enabled(); // others sleep: one in their window is due
  if (!is_extra) {
    beacon_due_ = false;
    relay_due_.reset();
  }
  answer_due_.reset();
  if (answers_left_ > 0 && --answers_left_ > 0)
    answer_due_ = now + config_.answer_gap;
  if (config_.duty.enabled() && search_.rests() && !config_.duty.knows_time(now, clock_.time())) {
    search_.on_beacon_sent(now);
    asks = true;
  }
  if (beacon_in_flight_)
    return;
  if (!is_extra && clock_.time().synchronised() && ++relays_ < config_.relays_max &&
      copies_ < config_.relay_copies) {
    const auto pause = config_.duty.enabled() ? 2 * spread_in_window() : config_.relay_pause;
    relay_due_ = now + rng_.between(pause / 2, pause);
  }
  if (!is_extra)
    timer_.done(now);
  beacon x;
  x.sequence = again ? beacon_sequence_ : ++beacon_sequence_;
  x.next_quarters = quarters(timer_.certain() - now + turn_wait(now));
  x.gradient = tree_.advertise();
  x.coordinates = place_.advertise();
  const auto stamp = clock_.stamp(now);
  x.clock = stamp.value_or(clock_stamp{});
  if (asks)
    x.clock.doubt = doubt_asks;
  x.heard = links_.heard(beacon::heard_max(x.clock));
  auto frame = frame_for(purpose::beacon, broadcast_mote, am::beacon, encode(x));
  if (stamp)
    frame.age_at = beacon::age_at;
  beacon_in_flight_ = true;
  ++counters_.beacons;
  emit(std::move(frame), out);
}

void router::on_beacon(mote_id source, byte_view payload, instant sfd, router_outputs& out,
                       instant now) {
  auto x = decode_beacon(payload);
  if (!x) {
    ++counters_.malformed;
    return;
  }
  const bool over_backbone = links_.has_backbone(source);
  if (over_backbone && x->clock.doubt != doubt_asks)
    x->clock.doubt = doubt_of(limit_of(x->clock.doubt) + config_.backbone.doubt);
  const auto what = links_.on_beacon(x->report(source, config_.self, has_route()), now);
  search_.on_beacon(now);
  on_stamp(x->clock, sfd, out, now);
  if (what == admission::repeated)
    return;
  // In a crowd neighbours come and go in the table, and a new one finds enough others.
  const bool is_crowd = 2 * links_.all().size() > links_.config().capacity;
  if (has_route() || is_in_crowd()) // else nobody does what we do: look for one
    timer_.hear();
  if ((what == admission::added && !is_crowd) || what == admission::restarted)
    hurry(now);
  if (what == admission::restarted)
    take(paths_.on_restarted(source, around(now), now), out);
  place_.on_beacon(source, x->coordinates, links_);
  if (what == admission::refused)
    return;
  if (x->gradient.root == source || over_backbone)
    links_.pin(source, true);
  if (tree_.on_beacon(source, x->gradient, links_, what == admission::restarted) &&
      now - helped_ >= config_.help_gap) {
    helped_ = now;
    hurry(now);
  }
  settle(out, now);
  feed(source, out, now);
  if (paths_.is_looking())
    take(paths_.look(source, around(now), now), out);
}

/// More neighbours than it can keep.
bool router::is_in_crowd() const {
  return links_.is_full();
}

/// A beacon should come soon. In a crowd many do that at the same time: an interval that is long
/// enough for most of them to receive the first ones, and keep quiet.
void router::hurry(instant now) {
  if (is_in_crowd())
    timer_.shorten(now, crowd_beacon);
  else
    timer_.reset(now);
}

bool router::may_hasten(instant now) {
  const auto gap = config_.sequence_gap + 2 * config_.duty.period;
  if (hastened_ && now - *hastened_ < gap)
    return false;
  hastened_ = now;
  return true;
}

/// A mote that may use none of its neighbours' routes before there is a newer sequence number gets
/// one: the sink is asked, and it comes quickly along the tree.
void router::feed(mote_id neighbour, router_outputs& out, instant now) {
  if (tree_.starves(neighbour) && may_hasten(now)) {
    ++counters_.sequence_requests;
    if (config_.is_sink) {
      tree_.hasten();
      beacon_due_ = true;
    } else {
      send_router_message(tree_.root(), sequence_request{}, out, now);
    }
  }
  if (tree_.is_urgent() && !config_.is_sink && !relay_due_)
    relay_due_ = now + rng_.between(0s, config_.relay_spread);
}

// The time.

void router::on_stamp(const clock_stamp& x, instant sfd, router_outputs& out, instant now) {
  const auto value = clock_.on_stamp(x, sfd);
  switch (value) {
  case stamp_value::news:
  case stamp_value::leap:
    if (news_)
      news_gap_ = now - *news_;
    news_ = now;
    out.emplace_back(clock_corrected{});
    if (!relay_due_)
      relay_due_ = now + rng_.between(0s, config_.relay_spread);
    copies_ = 1;
    relays_ = 0;
    search_.on_news(value == stamp_value::leap ? std::optional(clock_.time().last_leap())
                                               : std::nullopt,
                    clock_.time(), now);
    return;
  case stamp_value::in_dispute:
    ++counters_.disputes;
    break;
  case stamp_value::outdated:
    answer(x, now);
    break;
  case stamp_value::none:
  case stamp_value::point:
    break;
  }
  if (!clock_.is_of_last_round(x))
    return;
  if (answer_due_ && x.doubt != doubt_asks && ++answers_ >= config_.answer_copies &&
      !config_.is_sink) {
    answer_due_.reset();
    answers_left_ = 0;
  }
  if (++copies_ >= config_.relay_copies && !tree_.is_urgent())
    relay_due_.reset();
}

/// One who asks, or who has a time that is not the island's any more. Where radios sleep it is on
/// just now.
void router::answer(const clock_stamp& x, instant now) {
  const bool sleeps = config_.duty.enabled();
  if (x.doubt == doubt_asks)
    search_.on_asked(now);
  else if (x.root == mote_id{} && !sleeps) // it waits for a round
    return;
  const bool knows =
      sleeps ? config_.duty.knows_time(now, clock_.time()) : clock_.time().synchronised();
  const auto gap = sleeps ? config_.answer_gap : config_.answer_gap_awake;
  if (!knows || clock_.time().is_distrusted())
    return;
  if (sleeps && x.doubt == doubt_asks)
    answers_left_ = config_.answers_each;
  if (answer_due_ || now - answered_ < gap)
    return;
  answered_ = now;
  answers_ = 0;
  ++counters_.answers;
  answer_due_ =
      now + rng_.between(0s, sleeps ? config_.answer_spread : config_.answer_spread_awake);
}

time_knowledge router::knowledge(instant now) const {
  if (!clock_.time().synchronised() ||
      (config_.duty.enabled() && !config_.duty.knows_time(now, clock_.time())))
    return clock_.time().is_disputed() ? time_knowledge::doubted : time_knowledge::none;
  if (clock_.time().is_disputed())
    return time_knowledge::doubted;
  return clock_.is_trusted(now) ? time_knowledge::good : time_knowledge::stale;
}

void router::search_time(router_outputs& out, instant now) {
  if (config_.is_sink && std::exchange(steps_, clock_.time().steps()) != clock_.time().steps())
    search_.announce(now);
  switch (search_.on_time(now, knowledge(now), clock_.time())) {
  case time_search::beacon_due::ask:
    ++counters_.asks;
    send_beacon(out, now, true, true); // few are on to count it
    break;
  case time_search::beacon_due::plain:
    send_beacon(out, now, true);
    break;
  case time_search::beacon_due::none:
    break;
  }
}

/// Where radios sleep a mote whose time is wrong sends while nobody listens.
void router::watch_silence(bool acked, instant now) {
  if (!config_.duty.enabled() || config_.is_sink)
    return;
  if (acked) {
    silent_windows_ = 0;
  } else if (silent_windows_ == 0 || now - silent_ >= config_.duty.period / 2) {
    silent_ = now;
    if (++silent_windows_ == config_.silent_windows_max) {
      ++counters_.silences;
      clock_.distrust();
    }
  }
}

/// Motes that are as far from the sink as this one, or at the same temperature, need the same.
void router::request_period(router_outputs& out, instant now) {
  const auto wanted = clock_.wanted_period();
  const bool needs = wanted && tree_.has_route() && news_gap_ > *wanted * 5 / 4;
  if (!needs) {
    request_due_.reset();
    return;
  }
  if (!request_due_)
    request_due_ = std::max(now, requested_ + config_.period_request_gap) +
                   rng_.between(0s, config_.period_request_spread);
  if (*request_due_ > now)
    return;
  request_due_.reset();
  requested_ = now;
  ++counters_.period_requests;
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(*wanted).count();
  send_router_message(
      tree_.root(),
      period_request{std::chrono::duration<std::uint16_t>(static_cast<std::uint16_t>(whole))}, out,
      now);
}

/// What is known of links has changed: so may the tree and the coordinates.
void router::settle(router_outputs& out, instant now) {
  const auto parent = tree_.parent();
  const auto change = tree_.update(links_, now);
  if (tree_.parent() != parent) {
    links_.pin(parent, parent == tree_.root());
    links_.pin(tree_.parent(), true);
    clock_.follow(tree_.root());
  }
  if (change == gradient_change::lost) {
    hurry(now);
    seek_end_ = now + config_.seek_length;
  }
  if (place_.update(links_, now))
    timer_.shorten(now, change_beacon());
  if (places_.keep_epoch(place_.place_epoch())) // the sink has forgotten our place, too
    report_gap_ = config_.report_gap + rng_.between(0s, config_.report_gap);
  take(packets_.on_route(tree_.parent(), tree_.cost(), now), out, now);
  if (has_route()) {
    for (auto& x : questions_) {
      if (x.asks == 0)
        ask(x, out, now);
    }
  }
}

/// The sink has to know where everybody is, and whose child.
std::optional<instant> router::report_due() const {
  if (config_.is_sink || !tree_.has_route())
    return std::nullopt;
  const auto here = place_.likely_place();
  const bool has_changed = here != told_place_ || tree_.parent() != told_parent_;
  const bool is_first = here && !told_place_; // till then channels to us are looked for everywhere
  return reported_ + (is_first      ? config_.report_gap
                      : has_changed ? report_gap_
                                    : config_.report_period);
}

void router::report(router_outputs& out, instant now) {
  const auto due = report_due();
  if (!due || *due > now)
    return;
  const bool is_restless = now - reported_ < config_.report_period;
  report_gap_ = is_restless ? std::min(2 * report_gap_, config_.report_period) : config_.report_gap;
  told_place_ = place_.likely_place();
  reported_ = now;
  if (turn_wait(now) > 0s) // who has begun with others does not go on with them
    reported_ -= rng_.between(0s, config_.report_period / 4);
  send_router_message(tree_.root(), place_report{told_place_}, out, now);
}

// What comes.

router_outputs router::on_frame(mote_id source, std::uint8_t am_type, byte_view payload,
                                instant sfd, instant now, medium over) {
  router_outputs out;
  // Near the other end of a backbone the radio is not used beside it: a link has one cost.
  if (over == medium::radio && links_.has_backbone(source)) {
    ++counters_.beside_backbone;
    return out;
  }
  silent_windows_ = 0;
  keep_turns(now);
  switch (am_type) {
  case am::beacon:
    on_beacon(source, payload, sfd, out, now);
    break;
  case am::up:
  case am::down:
  case am::flood:
    links_.hear(source, now);
    learn_from(am_type, payload, now);
    take(packets_.on_frame(source, am_type, payload, now), out, now);
    break;
  case am::channel:
    links_.hear(source, now);
    learn_from(am_type, payload, now);
    take(paths_.on_frame(source, payload, around(now), now), out);
    break;
  case am::local:
    out.emplace_back(content_in{source, false, to_bytes(payload)});
    break;
  default:
    ++counters_.unknown_type;
  }
  report(out, now);
  return out;
}

router_outputs router::on_sent(std::uint64_t token, bool acked, unsigned transmissions,
                               instant now) {
  router_outputs out;
  keep_turns(now);
  if (const auto unicast = handed_.extract(token); unicast) {
    watch_silence(acked, now);
    links_.on_sent(*unicast, acked, transmissions, now);
    settle(out, now);
  }
  switch (static_cast<purpose>(token & ((1U << purpose_bits) - 1))) {
  case purpose::beacon:
    beacon_in_flight_ = false;
    break;
  case purpose::packet:
    take(packets_.on_sent(acked, now), out, now);
    break;
  case purpose::channel:
    take(paths_.on_sent(acked, acked ? surroundings() : around(now), now), out);
    break;
  case purpose::direct:
    if (auto sent = directs_.extract(token); sent && !acked) {
      ++counters_.detours;
      auto& x = *sent;
      const acting_on its(x.from);
      send_router_message(x.to, user_content{std::move(x.content)}, out, now);
    }
    break;
  }
  return out;
}

router_outputs router::on_time(instant now) {
  router_outputs out;
  keep_turns(now);
  send_directs(out, now);
  links_.on_time(now);
  settle(out, now);
  const bool round = clock_.on_time(now);
  if (round) {
    out.emplace_back(clock_corrected{});
    copies_ = relays_ = 0;
  }
  beacon_due_ = timer_.on_time(now) || round || beacon_due_;
  if (!tree_.has_route() && now < seek_end_)
    timer_.shorten(now, is_in_crowd() ? crowd_beacon : change_beacon());
  const bool is_turn = turn_ <= now && (beacon_due_ || (relay_due_ && *relay_due_ <= now));
  // Who sleeps cannot count answers, which leave at any time.
  if (is_turn || (answer_due_ && *answer_due_ <= now))
    send_beacon(out, now, !is_turn && config_.duty.enabled());
  search_time(out, now);
  request_period(out, now);
  take(packets_.on_time(now), out, now);
  take(paths_.on_time(now), out);
  if (paths_.is_looking())
    take(paths_.look(std::nullopt, around(now), now), out);
  for (auto q = questions_.begin(); q != questions_.end();) {
    if (q->due > now) {
      ++q;
      continue;
    }
    if (may_ask_again(*q)) {
      ask(*q, out, now);
      ++q;
      continue;
    }
    ++counters_.unanswered;
    const auto unanswered = *q;
    q = questions_.erase(q);
    begin(unanswered, places_.find_old(unanswered.destination), out, now);
  }
  report(out, now);
  return out;
}

instant router::deadline() const {
  auto next = timer_.deadline();
  const auto consider = [&next](std::optional<instant> x) {
    if (x)
      next = std::min(next, *x);
  };
  consider(links_.deadline());
  consider(place_.deadline());
  consider(clock_.deadline());
  if (relay_due_)
    consider(std::max(*relay_due_, turn_));
  consider(answer_due_);
  consider(search_.deadline());
  if (!search_.is_lost())
    consider(clock_.stale_at());
  consider(request_due_);
  if (beacon_due_ || !waiting_directs_.empty())
    consider(turn_);
  consider(packets_.deadline());
  consider(paths_.deadline());
  consider(report_due());
  for (const auto& x : questions_)
    consider(x.due);
  return next;
}

std::size_t router::footprint() const {
  const auto motes = links_.config().capacity;
  return links_.footprint() + gradient::footprint(motes) + coordinates::footprint(motes) +
         turns::footprint() + trickle::footprint() + clock_sync::footprint() +
         packets_.footprint() + paths_.footprint() + places_.footprint() + config_.direct_max * 12 +
         config_.questions_max * 24 + 32;
}

} // namespace rubicon::network
