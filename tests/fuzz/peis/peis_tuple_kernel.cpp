// The tuple layer of a whole kernel: messages of every tuple port from neighbours and strangers,
// each a legal one with octets changed, into a space that lives. The input is a row of steps of
// four octets (what, who, where to change, how many octets) and the octets to put there. Nothing
// may be exceeded of what the limits say, and no single package may cause more than a piece of
// work.
#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <string>

#include "peis/kernel/kernel.hpp"
#include "peis/link/link.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/wire/acknowledgement.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/package_walk.hpp"

using namespace rubicon;

namespace {

constexpr peer_id self{20};
constexpr peer_id neighbour{10};
constexpr peis::link_id link{1};
constexpr std::size_t limit = 200'000;
constexpr std::size_t outputs_max = 3'000;

peis::kernel_config config() {
  peis::kernel_config x;
  x.network.id = self;
  x.network.host_name = "fuzz";
  auto& tuples = x.tuples;
  tuples.tuples_max = 300;
  tuples.subscribers_max = 100;
  tuples.subscribers_octets_max = limit;
  tuples.held_octets_max = limit;
  tuples.written_octets_max = limit;
  tuples.orphaned_octets_max = limit / 10;
  tuples.strangers_max = 4;
  tuples.append_octets_max = 20'000;
  tuples.append_matches_max = 20;
  tuples.appends_waiting_octets_max = limit;
  tuples.pushes.messages_max = 16;
  tuples.pushes.octets_max = 20'000;
  tuples.pushes.total_max = limit;
  tuples.pushes.small = 2'000;
  tuples.missed_max = 8;
  return x;
}

peis::tuple sample(peer_id owner, std::string_view name) {
  peis::tuple x;
  x.owner = x.creator = owner;
  x.name = *peis::key::parse(name);
  x.value = peis::text_content("value").value;
  x.written = {2'000'000'000, 0};
  x.seqno = 1;
  return x;
}

bytes joined(bytes head, const payload& body) {
  head.insert(head.end(), body.view().begin(), body.view().end());
  return head;
}

/// A world around one kernel.
class world {
public:
  world() : kernel_(config(), random_stream(1), now_) {
    take(kernel_.on_link_open(link, peis::link_role::acceptor, now_));
    take(kernel_.on_link_octets(
        link, peis::encode(peis::connect_request{500, neighbour, 0, "default"}), now_));
    peis::host_record_message record;
    record.record.id = neighbour;
    record.record.magic = 7;
    record.record.marked = true;
    deliver(peis::package_type::link, peis::port::host_record, neighbour, peis::encode(record));
    for (int i = 0; i < 100; ++i)
      set(i);
    peis::subscription_id id{1};
    for (const auto* pattern : {"*", "a.*", "*.b.*", "log"}) {
      take(kernel_.subscriptions().subscribe(any_peer, pattern, id, now_));
      id = peis::subscription_id{id.value + 1};
    }
    take(kernel_.meta_tuples().declare("mi-x", now_));
    take(
        kernel_.subscriptions().subscribe_indirectly(self, "mi-x", peis::subscription_id{9}, now_));
  }

  void step(std::array<std::uint8_t, 4> what, byte_view change) {
    const auto source = what[1] < 160 ? neighbour : peer_id{100 + what[1] % 8};
    switch (what[0] % 10) {
    case 0:
      set(what[1]);
      return;
    case 1:
      pass(what[1] * 10ms);
      return;
    case 2:
      acknowledge_ = !acknowledge_;
      return;
    case 3:
      take(kernel_.tuples().remove("a.k" + std::to_string(what[1] % 100), now_));
      return;
    default:
      send(static_cast<std::size_t>(what[0] % 10) - 4, source, what, change);
    }
  }

  void finish() {
    pass(3s);
    deliver(
        peis::package_type::broadcast, peis::port::dead_host, neighbour,
        peis::encode(peis::dead_host_message{neighbour, peis::dead_host_message::reason::route}));
    take(kernel_.on_link_closed(link, now_));
    pass(200s);
    const auto all = kernel_.counters().tuples;
    assert(all.held_octets == 0 && all.subscribers == 0 && all.debtors == 0);
    assert(all.written_octets <= limit);
  }

private:
  void set(int i) {
    take(kernel_.tuples().set("a.k" + std::to_string(i % 100), peis::text_content("v"), now_));
  }

  void send(std::size_t kind, peer_id source, std::array<std::uint8_t, 4> what, byte_view change) {
    static constexpr std::array names{"log", "a.k1", "a.k2", "x.b.c", "mi-x", "kernel.name"};
    const std::string name = names[what[1] % names.size()];
    const auto pattern = peis::prototype_of(
        any_peer, *peis::key::parse(std::array{"*", "a.*", "", "log"}[what[1] % 4]));
    const auto own = sample(self, name);
    const auto theirs = sample(source, name);
    bytes octets;
    std::uint16_t port = 0;
    switch (kind) {
    case 0:
      port = peis::port::subscribe;
      octets = peis::encode(peis::subscribe_message{pattern, {}});
      break;
    case 1:
      port = peis::port::unsubscribe;
      octets = peis::encode_unsubscribe(pattern);
      break;
    case 2:
      port = peis::port::push;
      octets =
          joined(peis::encode_tuple_head(theirs, peis::tuple_message_kind::push), theirs.value);
      break;
    case 3:
      port = peis::port::set;
      octets = joined(peis::encode_tuple_head(own, peis::tuple_message_kind::set), own.value);
      break;
    case 4:
      port = peis::port::append_request;
      octets = joined(
          peis::encode_append_request_head({peis::prototype_of(self, pattern.name), theirs.value}),
          theirs.value);
      break;
    case 5:
      port = peis::port::append_notice;
      octets = joined(peis::encode_append_notice_head(theirs, 6), theirs.value);
      break;
    }
    // Times, numbers, MIME type and key are in the first 256 octets, the value behind them.
    const auto at = std::min<std::size_t>(what[2], octets.size());
    octets.resize(std::max(octets.size(), std::min(at + change.size(), peis::data_max)));
    std::copy_n(change.begin(), std::min(change.size(), octets.size() - at),
                octets.begin() + static_cast<std::ptrdiff_t>(at));
    deliver(peis::package_type::direct, port, source, octets);
  }

  void deliver(peis::package_type type, std::uint16_t port, peer_id source, byte_view data) {
    peis::package_header x;
    x.id = x.ack_id = next_id_++;
    x.type = type;
    const bool direct = type == peis::package_type::direct;
    x.flags = direct ? peis::package_flag::reliable : std::uint16_t{0};
    x.source = source;
    x.destination = direct ? self : any_peer;
    x.port = port;
    x.length = static_cast<std::uint16_t>(data.size());
    bytes octets;
    peis::encode(x, octets);
    octets.insert(octets.end(), data.begin(), data.end());
    take(kernel_.on_link_octets(link, octets, now_));
  }

  void pass(duration length) {
    const auto end = now_ + length;
    for (int turns = 0; kernel_.deadline() && *kernel_.deadline() <= end; ++turns) {
      assert(turns < 100'000);
      now_ = std::max(now_, *kernel_.deadline());
      take(kernel_.on_time(now_));
      answer();
    }
    now_ = end;
  }

  /// Checks what one call has led to; remembers what is to be acknowledged.
  void take(peis::outputs todo) {
    assert(todo.size() <= outputs_max);
    for (auto& x : todo) {
      if (auto* sent = std::get_if<peis::to_link>(&x))
        sent_.push_back(std::move(sent->octets));
    }
    const auto all = kernel_.counters().tuples;
    assert(all.tuples <= 300 && all.subscribers <= 100 && all.held_octets <= limit);
    assert(all.written_octets <= limit && all.subscribers_octets <= limit);
    assert(all.pushes_octets <= 2 * limit && all.debtors <= 16);
  }

  void answer() {
    std::vector<std::int32_t> ids;
    for (const auto& octets : std::exchange(sent_, {})) {
      for (auto rest = octets.view(); rest.size() >= peis::header_size;) {
        const auto header = peis::decode_header(rest);
        if (!header)
          break;
        if ((header->flags & peis::package_flag::reliable) != 0)
          ids.push_back(header->ack_id);
        rest = rest.subspan(std::min(rest.size(), peis::header_size + header->length));
      }
    }
    if (!acknowledge_)
      return;
    for (std::size_t i = 0; i < ids.size(); i += 100) {
      const std::vector<std::int32_t> some(
          ids.begin() + static_cast<std::ptrdiff_t>(i),
          ids.begin() + static_cast<std::ptrdiff_t>(std::min(ids.size(), i + 100)));
      deliver(peis::package_type::direct, peis::port::acknowledgements, neighbour,
              peis::encode_acknowledgement(some));
    }
  }

  instant now_{1s};
  peis::kernel kernel_;
  std::vector<payload> sent_;
  std::int32_t next_id_ = 1;
  bool acknowledge_ = true;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  byte_view rest(data, std::min<std::size_t>(size, 4096));
  world x;
  while (rest.size() >= 4) {
    const std::array<std::uint8_t, 4> what{rest[0], rest[1], rest[2], rest[3]};
    rest = rest.subspan(4);
    const auto change = rest.first(std::min<std::size_t>(what[3] % 32, rest.size()));
    rest = rest.subspan(change.size());
    x.step(what, change);
  }
  x.finish();
  return 0;
}
