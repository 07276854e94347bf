#include "network/router.hpp"

#include <algorithm>
#include <utility>

#include "network/am.hpp"
#include "network/clock/tick_plan.hpp"

namespace rubicon::network {

namespace {

/// A settled anchor reports itself every 8 minutes at most: so long the route to it may be broken
/// after a mote in between has restarted. Meanwhile everybody goes by the places that it had.
constexpr duration anchor_patience = 10min;
constexpr duration crowd_beacon = 4s;
constexpr duration lost_pause = 1s; ///< then it is seen again whether the time is known

coordinates own_place_of(const own_router_config& config, instant now) {
  return coordinates(
      {.self = config.self, .is_sink = config.is_sink, .anchor_patience = anchor_patience}, now);
}

} // namespace

router::router(router_config config, random_stream rng, instant now)
    : config_(config), rng_(rng), started_(now), links_(links_of(config)),
      tree_({.self = config.self, .is_root = config.is_sink}), help_(help_of(config), now),
      beacons_(trickle(beacons_of(config), random_stream(rng_.next()), now)),
      places_(own_place_of(config, now), places_of(config), config.self), reports_(now),
      questions_(config.questions_max), frames_(config_.backbone), directs_(config.direct_max) {
  packets_ = collection(packets_of(config), random_stream(rng_.next()));
  paths_ = channels(paths_of(config), random_stream(rng_.next()));
  auto further = rng_; // the others draw as they do without turns
  time_ = time_sync(time_of(config), random_stream(further.next()), now);
  turns_ = turns(config_.is_sink, config_.duty, random_stream(further.next()));
}

void router::use_slots(std::size_t count, instant now) {
  const tick_plan plan(clock().tick(now).value_or(config_.tick).period);
  sync().use_slots(plan.share_of(count), now);
}

/// For what is sent from now on.
void router::keep_turns(instant now) {
  const auto next = turns_.next(now, clock());
  turn_ = next > now ? next : instant{};
  // Who does not know when its neighbours listen keeps what it has for them, but for beacons.
  const auto held = time_.is_lost(now) ? now + lost_pause : turn_;
  packets_.hold(held);
  paths_.hold(held);
}

// Content.

std::optional<std::size_t> router::room_to(mote_id destination) const {
  if (!config_.is_sink)
    return collection::room_up() - 1;
  const auto room = packets_.room_down(destination);
  return room ? std::optional(*room - 1) : std::nullopt;
}

std::size_t room_to_all() {
  return collection::room_flood() - 1;
}

router_outputs router::send(mote_id destination, bytes content, instant now, bool in_slot) {
  router_outputs out;
  keep_turns(now);
  const bool is_near =
      destination != tree_.root() && links_.good(destination) && !directs_.is_full();
  if (config_.is_sink || !is_near) {
    send_router_message(destination, user_content{std::move(content)}, out, now, in_slot);
    return out;
  }
  auto frame = frames_.make(frame_purpose::direct, destination, am::local, content);
  directs_.add(std::move(frame), std::move(content));
  send_directs(out, now);
  return out;
}

void router::send_directs(router_outputs& out, instant now) {
  if (turn_ > now)
    return;
  for (auto& x : directs_.take_waiting())
    frames_.send(std::move(x), links_, out);
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
    reports_.on_packet(tree_.parent());
  take(config_.is_sink ? packets_.send_down(to, encode(x), now)
                       : packets_.send_up(encode(x), now, in_slot),
       out, now);
}

void router::take(collection_outputs todo, router_outputs& out, instant now) {
  for (auto& x : todo) {
    if (auto* packet = std::get_if<collected>(&x))
      on_content(std::move(*packet), out, now);
    else
      frames_.send(std::get<hop>(std::move(x)), links_, out);
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
      places_.learn(x.origin, *report->place, now);
  } else if (std::holds_alternative<sequence_request>(*message)) {
    if (config_.is_sink && help_.take_sequence(now)) {
      tree_.hasten();
      beacons_.request();
    }
  } else if (const auto* wanted = std::get_if<period_request>(&*message)) {
    if (config_.is_sink)
      sync().request_period(wanted->period, now);
  } else if (const auto* asked = std::get_if<place_question>(&*message)) {
    if (config_.is_sink)
      send_router_message(x.origin, place_answer{asked->mote, places_.find(asked->mote, now)}, out,
                          now);
  } else {
    on_answer(std::get<place_answer>(*message), out, now);
  }
}

void router::on_answer(const place_answer& x, router_outputs& out, instant now) {
  if (x.place)
    places_.learn(x.mote, *x.place, now);
  const bool is_useless = is_in_crowd() && (!x.place || !place().place());
  for (const auto& channel : questions_.on_answer(x.mote, is_useless, now))
    begin(channel, x.place ? x.place : places_.find_old(x.mote), out, now);
}

// Channels.

std::pair<channel_id, router_outputs> router::connect(mote_id destination,
                                                      const channel_schedule& schedule,
                                                      duration expiry, instant now) {
  router_outputs out;
  keep_turns(now);
  const awaited_channel x{paths_.next_id(), destination, schedule, expiry};
  auto place = places_.find(destination, now);
  const bool must_ask =
      !config_.is_sink && !place && !links_.good(destination) && !questions_.is_full();
  if (!place)
    place = places_.find_old(destination);
  const bool has_route = tree_.has_route();
  if (must_ask && (has_route || !place)) {
    questions_.add(x, has_route, now + answer_wait(now));
    if (has_route)
      ask(destination, out, now);
  } else {
    begin(x, place, out, now);
  }
  return {x.channel, std::move(out)};
}

duration router::answer_wait(instant now) const {
  return config_.question_timeout + (4 + tree_.hops() / 2) * turn_wait(now); // several hops a turn
}

void router::ask(mote_id destination, router_outputs& out, instant now) {
  ++counters_.questions;
  send_router_message(tree_.root(), place_question{destination}, out, now);
}

void router::begin(const awaited_channel& x, std::optional<virtual_coordinates> place,
                   router_outputs& out, instant now) {
  take(paths_.connect(x.channel, x.destination, place, x.schedule, x.expiry, around(now), now),
       out);
}

void router::begin_overdue(router_outputs& out, instant now) {
  for (const auto& x : questions_.on_time(is_in_crowd(), now + answer_wait(now), now)) {
    if (x.is_asked) {
      ask(x.what.destination, out, now);
      continue;
    }
    ++counters_.unanswered;
    begin(x.what, places_.find_old(x.what.destination), out, now);
  }
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
  questions_.remove(channel);
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
  x.own_place = place().presumed_place();
  x.is_crowd = is_in_crowd();
  x.turn_wait = turn_wait(now);
  x.beacon_wait = config_.beacon_wait();
  x.is_new = now - started_ < 2 * x.beacon_wait;
  x.parent = tree_.has_route() ? tree_.parent() : no_mote;
  for (const auto& each : links_.all()) {
    if (each.good)
      x.motes.push_back({each.mote, place().likely_place_of(each.mote)});
    else
      x.heard.push_back({each.mote, place().likely_place_of(each.mote)});
  }
  return x;
}

void router::take(channels_outputs todo, router_outputs& out) {
  for (auto& x : todo) {
    std::visit(
        [&](auto& y) {
          if constexpr (std::is_same_v<std::decay_t<decltype(y)>, channel_hop>)
            frames_.send(std::move(y), links_, out);
          else
            out.emplace_back(std::move(y));
        },
        x);
  }
}

// Beacons.

void router::send_beacon(router_outputs& out, instant now, bool again, bool asks) {
  again = again && beacons_.has_sent();                  // the first one has a number to count
  const bool is_extra = again && config_.duty.enabled(); // others sleep: one in their window is due
  if (!is_extra)
    beacons_.clear();
  if (time_.on_beacon_due(is_extra, now))
    asks = true;
  if (beacons_.is_in_flight())
    return;
  if (!is_extra) {
    time_.on_beacon_sent(now, rng_);
    beacons_.timer().done(now);
  }
  beacon x;
  x.sequence = beacons_.begin(again);
  x.next_quarters = quarters(beacons_.timer().certain() - now + turn_wait(now));
  x.gradient = tree_.advertise();
  x.coordinates = places_.own().advertise();
  const auto stamp = sync().stamp(now);
  x.clock = stamp.value_or(clock_stamp{});
  if (asks)
    x.clock.doubt = doubt_asks;
  x.heard = links_.heard(beacon::heard_max(x.clock));
  auto frame = frames_.make(frame_purpose::beacon, broadcast_mote, am::beacon, encode(x));
  if (stamp)
    frame.age_at = beacon::age_at;
  ++counters_.beacons;
  frames_.send(std::move(frame), links_, out);
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
  const auto what = links_.on_beacon(x->report(source, config_.self, tree_.has_route()), now);
  on_stamp(x->clock, sfd, out, now);
  if (what == admission::repeated)
    return;
  // In a crowd neighbours come and go in the table, and a new one finds enough others.
  const bool is_crowd = 2 * links_.all().size() > links_.config().capacity;
  if (tree_.has_route() || is_in_crowd()) // else no other does what we do: look for one
    beacons_.timer().hear();
  if ((what == admission::added && !is_crowd) || what == admission::restarted)
    hurry(now);
  if (what == admission::restarted)
    take(paths_.on_restarted(source, around(now), now), out);
  places_.own().on_beacon(source, x->coordinates, links_);
  if (what == admission::refused)
    return;
  if (x->gradient.root == source || over_backbone)
    links_.pin(source, true);
  if (tree_.on_beacon(source, x->gradient, links_, what == admission::restarted) &&
      help_.take_help(now))
    hurry(now);
  update_routes(out, now);
  request_sequence(source, out, now);
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
    beacons_.timer().shorten(now, crowd_beacon);
  else
    beacons_.timer().reset(now);
}

/// A mote that may use none of its neighbours' routes before there is a newer sequence number gets
/// one: the sink is asked, and it comes quickly along the tree.
void router::request_sequence(mote_id neighbour, router_outputs& out, instant now) {
  if (tree_.starves(neighbour) && help_.take_sequence(now)) {
    ++counters_.sequence_requests;
    if (config_.is_sink) {
      tree_.hasten();
      beacons_.request();
    } else {
      send_router_message(tree_.root(), sequence_request{}, out, now);
    }
  }
  if (tree_.is_urgent() && !config_.is_sink)
    time_.relay().hasten(now, rng_);
}

// The time.

void router::on_stamp(const clock_stamp& x, instant sfd, router_outputs& out, instant now) {
  const auto effect = time_.on_stamp(x, sfd, tree_.is_urgent(), now, rng_);
  if (effect.is_news)
    out.emplace_back(clock_corrected{});
  counters_.disputes += effect.disputes ? 1 : 0;
  counters_.answers += effect.is_answered ? 1 : 0;
}

void router::search_time(router_outputs& out, instant now) {
  switch (time_.search_time(now)) {
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

void router::request_period(router_outputs& out, instant now) {
  const auto period = time_.request_period(tree_.has_route(), now, rng_);
  if (!period)
    return;
  ++counters_.period_requests;
  using seconds_16 = decltype(network::period_request::period);
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(*period).count();
  send_router_message(tree_.root(),
                      network::period_request{seconds_16(static_cast<std::uint16_t>(whole))}, out,
                      now);
}

/// What is known of links has changed: so may the tree and the coordinates.
void router::update_routes(router_outputs& out, instant now) {
  const auto parent = tree_.parent();
  const auto change = tree_.update(links_, now);
  if (tree_.parent() != parent) {
    links_.pin(parent, parent == tree_.root());
    links_.pin(tree_.parent(), true);
    sync().follow(tree_.root());
  }
  if (change == gradient_change::lost) {
    hurry(now);
    help_.on_lost(now);
  }
  if (places_.own().update(links_, now))
    beacons_.timer().shorten(now, config_.change_beacon());
  if (places_.keep_epoch()) // the sink has forgotten our place, too
    reports_.on_forgotten(rng_);
  take(packets_.on_route(tree_.parent(), tree_.cost(), now), out, now);
  if (tree_.has_route())
    for (const auto& destination : questions_.take_unasked(now + answer_wait(now)))
      ask(destination, out, now);
}

/// The sink has to know where everybody is, and whose child.
std::optional<instant> router::report_due() const {
  if (config_.is_sink || !tree_.has_route())
    return std::nullopt;
  return reports_.due(place().likely_place(), tree_.parent());
}

void router::report(router_outputs& out, instant now) {
  const auto due = report_due();
  if (!due || *due > now)
    return;
  const auto here = place().likely_place();
  reports_.on_report(here, turn_wait(now) > 0s, now, rng_);
  send_router_message(tree_.root(), place_report{here}, out, now);
}

// What is received, and when time passes.

router_outputs router::on_frame(mote_id source, std::uint8_t am_type, byte_view payload,
                                instant sfd, instant now, medium over) {
  router_outputs out;
  // Near the other end of a backbone the radio is not used beside it: a link has one cost.
  if (over == medium::radio && links_.has_backbone(source)) {
    ++counters_.beside_backbone;
    return out;
  }
  time_.on_received();
  keep_turns(now);
  switch (am_type) {
  case am::beacon:
    on_beacon(source, payload, sfd, out, now);
    break;
  case am::up:
  case am::down:
  case am::flood:
    links_.hear(source, now);
    places_.learn_from(am_type, payload, now);
    take(packets_.on_frame(source, am_type, payload, now), out, now);
    break;
  case am::channel:
    links_.hear(source, now);
    places_.learn_from(am_type, payload, now);
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
  if (const auto unicast = frames_.on_sent(token); unicast) {
    counters_.silences += time_.on_unicast(acked, now) ? 1 : 0;
    links_.on_sent(*unicast, acked, transmissions, now);
    update_routes(out, now);
  }
  switch (frame_tokens::purpose_of(token)) {
  case frame_purpose::beacon:
    beacons_.on_sent();
    break;
  case frame_purpose::packet:
    take(packets_.on_sent(acked, now), out, now);
    break;
  case frame_purpose::channel:
    take(paths_.on_sent(acked, acked ? surroundings() : around(now), now), out);
    break;
  case frame_purpose::direct:
    if (auto sent = directs_.on_sent(token); sent && !acked) {
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
  update_routes(out, now);
  if (time_.on_time(now)) {
    out.emplace_back(clock_corrected{});
    beacons_.request();
  }
  beacons_.on_time(now);
  if (!tree_.has_route() && help_.may_seek(now))
    beacons_.timer().shorten(now, is_in_crowd() ? crowd_beacon : config_.change_beacon());
  const auto relay = time_.relay().due();
  const bool is_turn = turn_ <= now && (beacons_.is_due() || (relay && *relay <= now));
  // Who sleeps cannot count answers, which leave at any time.
  if (is_turn || time_.is_answer_due(now))
    send_beacon(out, now, !is_turn && config_.duty.enabled());
  search_time(out, now);
  request_period(out, now);
  take(packets_.on_time(now), out, now);
  take(paths_.on_time(now), out);
  if (paths_.is_looking())
    take(paths_.look(std::nullopt, around(now), now), out);
  begin_overdue(out, now);
  report(out, now);
  return out;
}

instant router::deadline() const {
  auto next = beacons_.timer().deadline();
  const auto consider = [&next](std::optional<instant> x) {
    if (x)
      next = std::min(next, *x);
  };
  consider(links_.deadline());
  consider(place().deadline());
  consider(time_.deadline(turn_));
  if (beacons_.is_due() || directs_.has_waiting())
    consider(turn_);
  consider(packets_.deadline());
  consider(paths_.deadline());
  consider(report_due());
  consider(questions_.deadline());
  return next;
}

std::size_t router::footprint() const {
  const auto motes = links_.config().capacity;
  return links_.footprint() + gradient::footprint(motes) + coordinates::footprint(motes) +
         turns::footprint() + trickle::footprint() + time_sync::footprint() + packets_.footprint() +
         paths_.footprint() + places_.footprint() + config_.direct_max * 12 +
         config_.questions_max * 24 + 32;
}

} // namespace rubicon::network
