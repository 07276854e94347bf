#include "unit/peis/fixture.hpp"

#include <algorithm>
#include <charconv>

#include "peis/wire/host_query.hpp"
#include "peis/wire/link_url.hpp"

namespace rubicon::peis::test {

namespace {

constexpr std::ptrdiff_t mark_at = 540;  // docs/peis-wire.md 5
constexpr std::ptrdiff_t record_at = 72; // docs/peis-wire.md 4
constexpr duration first_wait = 200ms;   // of TCP
constexpr duration wait_max = 120s;

} // namespace

kernel_config config_of(std::int32_t id) {
  kernel_config config;
  config.network.id = peer_id{id};
  config.network.name = "peer" + std::to_string(id);
  config.network.host_name = "host" + std::to_string(id);
  config.network.network = "test";
  config.network.connections.announces = false;
  return config;
}

kernel_config lan_config_of(std::int32_t id) {
  auto config = config_of(id);
  config.network.connections.announces = true;
  config.network.addresses = {inproc_address(1, peer_id{id})};
  return config;
}

peer_id world::add(std::int32_t id) {
  return add(config_of(id));
}

peer_id world::add(kernel_config config) {
  const auto id = config.network.id;
  auto& x = peers_[id];
  x.config = std::move(config);
  start(x);
  return id;
}

void world::add_line(int count) {
  for (int i = 1; i <= count; ++i) {
    auto config = config_of(i);
    config.network.connections.manager = false;
    add(config);
  }
  for (int i = 1; i < count; ++i)
    connect(peer_id{i}, peer_id{i + 1});
}

void world::start(peer& x) {
  const auto path = to_string(x.config.network.id) + '/' + std::to_string(x.lives++);
  x.kernel = rubicon::peis::kernel(x.config, random_stream(seed_, path), now_);
  note_deadline(x.config.network.id);
}

void world::restart(peer_id id) {
  auto& x = peers_.at(id);
  x.alive = true;
  start(x);
}

void world::kill(peer_id id) {
  std::vector<link_id> links;
  for (const auto& [link, x] : cables_) {
    if (x.a == id || x.b == id)
      links.push_back(link);
  }
  power_off(id);
  for (const auto link : links)
    cut(link);
}

void world::power_off(peer_id id) {
  peers_.at(id).alive = false;
  note_deadline(id);
}

void world::note_deadline(peer_id id) {
  auto& x = peers_.at(id);
  if (x.due)
    due_.erase({*x.due, id});
  x.due = x.alive && !x.paused ? x.kernel.deadline() : std::nullopt;
  if (x.due)
    due_.emplace(*x.due, id);
}

/// Now, or when it goes on.
void world::tell(peer_id id, std::function<void()> what) {
  auto& x = peers_.at(id);
  if (x.paused)
    x.missed.push_back(std::move(what));
  else
    what();
}

void world::pause(peer_id id) {
  peers_.at(id).paused = true;
  note_deadline(id);
}

void world::resume(peer_id id) {
  auto& x = peers_.at(id);
  x.paused = false;
  for (const auto missed = std::exchange(x.missed, {}); const auto& what : missed)
    what();
  note_deadline(id);
}

std::vector<peer_id> world::peers() const {
  std::vector<peer_id> ids;
  for (const auto& [id, x] : peers_)
    ids.push_back(id);
  return ids;
}

bool world::joined(peer_id a, peer_id b) const {
  return alive(a) && alive(b) && !(separated && separated(a, b));
}

void world::later(std::function<void()> what, duration delay) {
  in_flight_.emplace(now_ + delay, std::move(what));
}

link_id world::connect(peer_id a, peer_id b, duration delay) {
  return open(a, b, delay, std::nullopt);
}

link_id world::open(peer_id a, peer_id b, duration delay, std::optional<attempt_id> attempt) {
  const link_id link{next_link_++};
  auto& x = cables_[link];
  x = {a, b, delay, {}, {}, {}};
  x.from_a.request_due = true;
  tell(b, [=, this] { perform(b, at(b).on_link_open(link, link_role::acceptor, now_)); });
  perform(a, at(a).on_link_open(link, link_role::initiator, now_, attempt));
  return link;
}

void world::answer(peer_id from, const connect_to& x) {
  const auto url = parse_link_url(x.url);
  std::int32_t id = 0;
  if (url)
    std::from_chars(url->host.data(), url->host.data() + url->host.size(), id);
  const peer_id to{id};
  const auto lives = peers_.at(from).lives;
  later(
      [=, this, attempt = x.attempt, where = x.url] {
        if (!alive(from) || peers_.at(from).lives != lives || !peers_.contains(to))
          return;
        if (separated && separated(from, to))
          return; // nobody answers
        if (alive(to) && !vacant.contains(where))
          open(from, to, 1ms, attempt);
        else
          perform(from, at(from).on_attempt_failed(attempt, now_));
      },
      1ms);
}

void world::spread(peer_id from, const announce& x) {
  auto octets = to_bytes(x.octets.view());
  if (unmarked.contains(from))
    std::fill_n(octets.begin() + record_at + mark_at, 4, std::uint8_t{0});
  for (const auto& [to, other] : peers_) {
    if (other.config.network.connections.announces && !other.config.network.addresses.empty())
      later(
          [=, this, to = to] {
            if (joined(from, to))
              tell(to, [=, this] { perform(to, at(to).on_announcement(octets, now_)); });
          },
          1ms);
  }
}

void world::cut(link_id link) {
  const auto x = cables_.at(link);
  cables_.erase(link);
  for (const auto end : {x.a, x.b}) {
    if (alive(end))
      perform(end, at(end).on_link_closed(link, now_));
  }
}

void world::perform(peer_id id, outputs todo) {
  auto& x = peers_.at(id);
  for (auto& output : todo) {
    if (const auto* octets = std::get_if<to_link>(&output)) {
      carry(id, *octets);
    } else if (const auto* wish = std::get_if<connect_to>(&output)) {
      answer(id, *wish);
    } else if (const auto* news = std::get_if<announce>(&output)) {
      spread(id, *news);
    } else {
      if (const auto* closed = std::get_if<close_link>(&output)) {
        close(id, closed->link);
      }
      x.log.emplace_back(now_, std::move(output));
    }
  }
  note_deadline(id);
}

void world::close(peer_id by, link_id link) {
  const auto cable = cables_.find(link);
  if (cable == cables_.end())
    return;
  const auto other = cable->second.a == by ? cable->second.b : cable->second.a;
  if (tcp && alive(other) && !joined(by, other) && !cable->second.closed_by) {
    cable->second.closed_by = by;
    return;
  }
  const bool told = joined(by, other);
  later(
      [=, this] {
        cables_.erase(link);
        if (told && alive(other))
          tell(other, [=, this] { perform(other, at(other).on_link_closed(link, now_)); });
      },
      cable->second.delay);
}

bool world::answer_from_memory(peer_id relay, peer_id asker, link_id link,
                               const package_header& header, byte_view data) {
  if (header.port != port::host_query || header.seqlen > 0 || header.destination == relay)
    return false;
  const auto query = decode_host_query(data);
  const auto known = memories_[relay].find(header.destination);
  if (!query || query->magic != any_magic || known == memories_[relay].end())
    return false;
  const auto answer = encode(host_record_message{known->second, true});
  package_header back;
  back.id = back.ack_id = next_package_++;
  back.type = package_type::direct;
  back.hops = 1;
  back.source = relay;
  back.destination = header.source;
  back.port = port::host_record;
  back.length = static_cast<std::uint16_t>(answer.size());
  bytes octets;
  encode(back, octets);
  octets.insert(octets.end(), answer.begin(), answer.end());
  later(
      [=, this, octets = std::move(octets)] {
        if (cables_.contains(link) && joined(relay, asker))
          perform(asker, at(asker).on_link_octets(link, octets, now_));
      },
      1ms);
  return true;
}

/// Cuts the stream into packages, so that single ones can be lost.
void world::carry(peer_id from, const to_link& x) {
  const auto found = cables_.find(x.link);
  if (found == cables_.end())
    return;
  auto& cable = found->second;
  const bool is_a = cable.a == from;
  auto& way = is_a ? cable.from_a : cable.from_b;
  bytes kept;
  way.decoder.feed(x.octets.view());
  if (way.request_due) {
    if (const auto request = way.decoder.take_connect_request()) {
      kept = to_bytes(*request);
      way.request_due = false;
    }
  }
  while (const auto package = way.decoder.next()) {
    const bool unknown_to_it =
        package->header.port == port::heartbeat && unmarked.contains(package->header.source);
    const bool lost = unknown_to_it || (keep && !keep(package->header));
    packages.push_back({now_, from, package->header, lost});
    if (lost ||
        answer_from_memory(is_a ? cable.b : cable.a, from, x.link, package->header, package->data))
      continue;
    encode(package->header, kept);
    kept.insert(kept.end(), package->data.begin(), package->data.end());
    if (package->header.port == port::host_record && unmarked.contains(package->header.source))
      std::fill_n(kept.end() - static_cast<std::ptrdiff_t>(package->data.size()) + mark_at, 4,
                  std::uint8_t{0});
  }
  const auto link = x.link;
  const auto size = octets_per_second > 0 ? x.octets.size() : SIZE_MAX;
  const auto sent = [=, this] {
    if (cables_.contains(link) && alive(from))
      tell(from, [=, this] { perform(from, at(from).on_link_sent(link, size, now_)); });
  };
  duration takes = cable.delay;
  if (octets_per_second > 0) {
    const auto nanoseconds = 1e9 * static_cast<double>(x.octets.size()) / octets_per_second;
    way.busy = std::max(way.busy, now_) + duration(static_cast<duration::rep>(nanoseconds));
    takes += way.busy - now_;
  }
  later([=, this, octets = std::move(kept),
         written = x.octets.size()] { arrive(link, is_a, octets, written); },
        takes);
  if (drains && !tcp)
    later(sent, takes);
}

void world::arrive(link_id link, bool from_a, bytes octets, std::size_t written) {
  const auto found = cables_.find(link);
  if (found == cables_.end())
    return;
  auto& x = found->second;
  auto& way = from_a ? x.from_a : x.from_b;
  const auto from = from_a ? x.a : x.b;
  const auto to = from_a ? x.b : x.a;
  if (!tcp) {
    if (joined(from, to))
      deliver(link, to, octets);
    return;
  }
  way.held.emplace_back(std::move(octets), written);
  if (way.held.size() > 1 || stuck.contains(link))
    return;
  way.wait = first_wait;
  if (joined(from, to))
    send_again(link, from_a);
  else
    later([=, this] { send_again(link, from_a); }, way.wait);
}

void world::send_again(link_id link, bool from_a) {
  const auto found = cables_.find(link);
  if (found == cables_.end())
    return;
  auto& x = found->second;
  auto& way = from_a ? x.from_a : x.from_b;
  const auto from = from_a ? x.a : x.b;
  const auto to = from_a ? x.b : x.a;
  if (!joined(from, to)) {
    way.wait = std::min(2 * way.wait, wait_max);
    later([=, this] { send_again(link, from_a); }, way.wait);
    return;
  }
  if (x.closed_by == to) {
    cables_.erase(found);
    tell(from, [=, this] { perform(from, at(from).on_link_closed(link, now_)); });
    return;
  }
  for (const auto held = std::exchange(way.held, {}); const auto& [octets, written] : held) {
    deliver(link, to, octets);
    if (drains)
      tell(from, [=, this] { perform(from, at(from).on_link_sent(link, written, now_)); });
  }
}

void world::deliver(link_id link, peer_id to, const bytes& octets) {
  if (cables_.contains(link))
    tell(to, [=, this] { perform(to, at(to).on_link_octets(link, octets, now_)); });
}

void world::run_for(duration length) {
  const auto end = now_ + length;
  for (;;) {
    const auto alarm = due_.empty() ? end : std::max(due_.begin()->first, now_);
    const auto arrival = in_flight_.empty() ? end : in_flight_.begin()->first;
    if (arrival < end && arrival <= alarm) {
      const auto x = in_flight_.extract(in_flight_.begin());
      now_ = std::max(now_, x.key());
      x.mapped()();
    } else if (alarm < end) {
      now_ = alarm;
      const auto who = due_.begin()->second;
      auto& x = peers_.at(who);
      ++x.wakeups;
      perform(who, x.kernel.on_time(now_));
    } else {
      break;
    }
  }
  now_ = end;
}

void world::clear_logs() {
  for (auto& [id, x] : peers_)
    x.log.clear();
  packages.clear();
}

} // namespace rubicon::peis::test
