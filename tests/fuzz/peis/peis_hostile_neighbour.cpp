// Two whole kernels joined by a link, and a third neighbour of both that keeps to no rule. An input
// is a list of its deeds, mixed with what the kernels' users ask for and with time that passes.
// Whatever it does: nothing fails, tables stay within their limits, every request has one outcome.
#include <array>
#include <cassert>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "peis/kernel/kernel.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/wire/acknowledgement.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/host_query.hpp"
#include "peis/wire/trace.hpp"

using namespace rubicon;

namespace {

constexpr std::size_t deeds_max = 64;
constexpr peis::link_id joint{1}; ///< between the kernels
constexpr peer_id hostile{666};
constexpr std::array<peer_id, 16> somebody{
    {hostile, peer_id{1}, peer_id{2}, peer_id{3}, peer_id{65535}, peer_id{0}, any_peer, peer_id{4},
     peer_id{5}, peer_id{6}, peer_id{7}, peer_id{70000}, peer_id{0x7fffffff}, peer_id{-7},
     peer_id{8}, peer_id{9}}};
constexpr std::array<duration, 16> pauses{
    {0s, 1us, 1ms, 5ms, 10ms, 20ms, 100ms, 400ms, 500ms, 1s, 2s, 3s, 5s, 11s, 31s, 61s}};

/// What is read ahead of the input's end is zero.
class deed_reader {
public:
  explicit deed_reader(byte_view octets) : rest_(octets) {}

  [[nodiscard]] bool done() const { return rest_.empty(); }
  std::uint8_t octet() {
    if (rest_.empty())
      return 0;
    const auto x = rest_.front();
    rest_ = rest_.subspan(1);
    return x;
  }
  byte_view some(std::size_t count) {
    const auto x = rest_.first(std::min(count, rest_.size()));
    rest_ = rest_.subspan(x.size());
    return x;
  }
  template <class T, std::size_t N>
  const T& one_of(const std::array<T, N>& all, std::size_t choice) {
    return all[choice % N];
  }

private:
  byte_view rest_;
};

peis::host_record record_of(peer_id id, bool marked) {
  peis::host_record x;
  x.id = id;
  x.magic = 7;
  x.host_name = "else";
  x.full_name = "hostile@else!1";
  x.addresses.push_back(peis::tcp_address("eth0", false, {192, 0, 2, 1}, 8000));
  x.cluster = 1;
  x.marked = marked;
  return x;
}

bytes with_value(bytes head, byte_view value) {
  head.insert(head.end(), value.begin(), value.end());
  return head;
}

peis::tuple some_tuple(const char* name) {
  peis::tuple x;
  x.name = *peis::key::parse(name);
  x.owner = x.creator = hostile;
  x.value = payload(bytes{'o', 'n', 0});
  x.mimetype = "text/plain";
  x.form = peis::encoding::text;
  return x;
}

/// One good message of each service, to be spoilt.
const std::vector<std::pair<std::uint16_t, bytes>>& good_messages() {
  static const auto all = [] {
    using namespace peis;
    std::vector<std::pair<std::uint16_t, bytes>> x;
    routing_page page;
    page.seqno = 5;
    for (int i = 1; i <= 9; ++i)
      page.entries.push_back({peer_id{i}, 5, 7, static_cast<std::uint8_t>(i), 3});
    x.emplace_back(port::routing, encode(page));
    x.emplace_back(port::trace, encode(trace_message{{hostile}}));
    x.emplace_back(port::trace_reply, encode(trace_message{{peer_id{1}, hostile}}));
    x.emplace_back(port::heartbeat, encode(heartbeat{instant{1s}, instant{1s}, 0s}));
    x.emplace_back(port::dead_host,
                   encode(dead_host_message{peer_id{2}, dead_host_message::reason::route}));
    x.emplace_back(port::dead_host,
                   encode(dead_host_message{hostile, dead_host_message::reason::reborn}));
    x.emplace_back(port::clock, encode(clock_message{1'000'000'002s, false, 0s}));
    x.emplace_back(port::host_query, encode(host_query{hostile, any_magic}));
    x.emplace_back(port::host_record, encode(host_record_message{record_of(hostile, true), false}));
    x.emplace_back(port::host_record,
                   encode(host_record_message{record_of(peer_id{3}, false), true}));
    x.emplace_back(port::acknowledgements, encode_acknowledgement(std::array{1, 2, 3}));
    prototype wanted = prototype_of(any_peer, *key::parse("*"));
    x.emplace_back(port::subscribe, encode(subscribe_message{wanted, lifetime_tag{false, 60}}));
    x.emplace_back(port::unsubscribe, encode_unsubscribe(wanted));
    const auto told = some_tuple("a.b");
    const auto value = to_bytes(told.value.view());
    x.emplace_back(port::push,
                   with_value(encode_tuple_head(told, tuple_message_kind::push), value));
    auto asked = some_tuple("kernel.do-quit");
    asked.owner = peer_id{1};
    x.emplace_back(port::set, with_value(encode_tuple_head(asked, tuple_message_kind::set), value));
    const append_request more{prototype_of(peer_id{1}, *key::parse("x")), told.value};
    x.emplace_back(port::append_request, with_value(encode_append_request_head(more), value));
    x.emplace_back(port::append_notice,
                   with_value(encode_append_notice_head(told, value.size()), value));
    x.emplace_back(port::user_first, to_bytes("some text"));
    return x;
  }();
  return all;
}

peis::kernel_config config_of(std::int32_t id) {
  peis::kernel_config x;
  x.network.id = peer_id{id};
  x.network.host_name = "host" + std::to_string(id);
  x.network.addresses.push_back(
      peis::tcp_address("eth0", false, {192, 0, 2, static_cast<std::uint8_t>(id)}, 8000));
  return x;
}

class arena {
public:
  arena() {
    for (const int i : {0, 1})
      kernels_[idx(i)] = peis::kernel(config_of(i + 1), random_stream(idx(i)), now_);
    open_joint();
    for (const int i : {0, 1}) {
      perform(idx(i), kernels_[idx(i)].tuples().set("x", peis::text_content("1"), now_));
      static_cast<void>(kernels_[idx(i)].messages().hook_port(peis::port::user_first));
    }
    pass(20ms);
    for (const int i : {0, 1})
      befriend(idx(i));
    pass(20ms);
  }

  void run(byte_view input) {
    deed_reader from(input);
    for (std::size_t i = 0; i < deeds_max && !from.done(); ++i)
      deed(from);
    settle();
  }

private:
  static std::size_t idx(int i) { return static_cast<std::size_t>(i); }

  void open_joint() {
    joined_ = true;
    perform(1, kernels_[1].on_link_open(joint, peis::link_role::acceptor, now_));
    perform(0, kernels_[0].on_link_open(joint, peis::link_role::initiator, now_));
  }

  void befriend(std::size_t whom) {
    links_[whom] = peis::link_id{next_link_++};
    heard_[whom] = peis::stream_decoder();
    perform(whom, kernels_[whom].on_link_open(*links_[whom], peis::link_role::acceptor, now_));
    say(whom, peis::encode(peis::connect_request{500, hostile, peis::connect_request::for_merge,
                                                 config_of(1).network.network}));
  }

  void say(std::size_t whom, const bytes& octets) {
    if (links_[whom])
      perform(whom, kernels_[whom].on_link_octets(*links_[whom], octets, now_));
    carry();
  }

  void deed(deed_reader& from) {
    const auto what = from.octet();
    const std::size_t whom = what >> 7;
    switch (what & 15) {
    default:
      send_package(from, whom);
      return;
    case 10:
      pass(from.one_of(pauses, from.octet()));
      return;
    case 11:
      use_kernel(from, whom);
      return;
    case 12:
      acknowledge(from, whom);
      return;
    case 13:
      change_links(from, whom);
      return;
    case 14:
      say(whom, to_bytes(from.some(from.octet())));
      return;
    case 15:
      announce(from, whom);
      return;
    }
  }

  /// A package in which hardly anything is sure to be right.
  void send_package(deed_reader& from, std::size_t whom) {
    const auto how = from.octet();
    const auto& [port, good] = good_messages()[from.octet() % good_messages().size()];
    const auto ends = from.octet();
    const auto rest = from.octet();
    peis::package_header header;
    header.port = (how & 64) != 0 ? from.octet() : port;
    header.type = static_cast<peis::package_type>(how & 3);
    header.source = somebody[ends >> 4];
    header.destination = somebody[ends & 15];
    header.flags = rest & 15;
    header.hops = static_cast<std::uint8_t>(1 + (rest >> 4));
    header.id = (how & 4) != 0 ? last_id_ : ++last_id_;
    header.ack_id = (how & 8) != 0 ? last_id_ + 1'000'000 : header.id;
    if ((how & 16) != 0)
      fragment(header, from);
    auto data = spoilt(good, from);
    if (header.seqlen > 0 && header.seqnum + 1 < header.seqlen)
      data.resize(peis::data_max);
    header.length = static_cast<std::uint16_t>(data.size());
    if ((how & 32) != 0)
      header.length = static_cast<std::uint16_t>(header.length + from.octet());
    bytes octets;
    peis::encode(header, octets);
    octets.insert(octets.end(), data.begin(), data.end());
    say(whom, octets);
  }

  static void fragment(peis::package_header& header, deed_reader& from) {
    constexpr std::array<std::uint16_t, 8> counts{{1, 2, 3, 4, 16, 1000, 16384, 40000}};
    const auto x = from.octet();
    header.seqlen = counts[x & 7];
    header.seqnum = static_cast<std::uint16_t>(
        (x & 8) != 0 ? header.seqlen - 1 : static_cast<unsigned>(x >> 4) % header.seqlen);
    header.seqid = from.octet();
  }

  static bytes spoilt(bytes x, deed_reader& from) {
    const auto how = from.octet();
    for (unsigned i = how & 3; i > 0 && !x.empty(); --i) {
      const auto at = from.octet() * ((how & 4) != 0 ? 4U : 1U);
      x[at % x.size()] = from.octet();
    }
    if ((how & 8) != 0) {
      const auto other = from.some(from.octet());
      x.insert(x.end(), other.begin(), other.end());
    }
    if ((how & 16) != 0)
      x.resize(std::min<std::size_t>(peis::data_max, std::size_t{from.octet()} * 4));
    if ((how & 32) != 0)
      x.resize(x.size() - std::min<std::size_t>(x.size(), from.octet()));
    x.resize(std::min(x.size(), peis::data_max));
    return x;
  }

  /// Of what a kernel has asked the hostile neighbour for, or of what it has not.
  void acknowledge(deed_reader& from, std::size_t whom) {
    const auto how = from.octet();
    auto ids = std::exchange(asked_[whom], {});
    if ((how & 1) != 0)
      ids.push_back(from.octet());
    if ((how & 2) != 0 && !ids.empty())
      ids.push_back(ids.front());
    ids.resize(std::min(ids.size(), peis::acknowledgements_max));
    peis::package_header header;
    header.source = hostile;
    header.destination = kernels_[whom].id();
    header.port = peis::port::acknowledgements;
    header.id = header.ack_id = ++last_id_;
    const auto data = peis::encode_acknowledgement(ids);
    header.length = static_cast<std::uint16_t>(data.size());
    bytes octets;
    peis::encode(header, octets);
    octets.insert(octets.end(), data.begin(), data.end());
    say(whom, octets);
  }

  void use_kernel(deed_reader& from, std::size_t who) {
    auto& kernel = kernels_[who];
    const auto how = from.octet();
    const auto to = somebody[how >> 4];
    const peis::request_id request{++last_request_};
    const peis::subscription_id watch{++last_request_};
    const std::size_t size = std::size_t{from.octet()} * ((how & 8) != 0 ? 64 : 1);
    switch (how & 7) {
    case 0:
      expect(who, request);
      perform(who, kernel.messages().send(to, peis::port::user_first, payload(bytes(size)), true,
                                          peis::priority::normal, request, now_));
      break;
    case 1:
      perform(who, kernel.tuples().set("x", peis::binary_content(payload(bytes(size))), now_));
      break;
    case 2:
      perform(who,
              kernel.subscriptions().subscribe(to.value > 0 ? to : any_peer, "*", watch, now_));
      break;
    case 3:
      perform(who,
              kernel.messages().broadcast(peis::port::user_first, payload(bytes(size)), {}, now_));
      break;
    case 4:
      expect(who, request);
      perform(who, kernel.tuples().set_remote(to, "x", peis::text_content("2"), request, now_));
      break;
    case 5:
      perform(who, kernel.messages().trace(to, request, now_));
      break;
    case 6:
      expect(who, request);
      perform(who, kernel.tuples().append(
                       peis::prototype_of(to.value > 0 ? to : any_peer, *peis::key::parse("x")),
                       payload(bytes(size)), now_, request));
      break;
    case 7:
      perform(who, kernel.subscriptions().subscribe_indirectly(to.value > 0 ? to : peer_id{1}, "m",
                                                               watch, now_));
      break;
    }
    carry();
  }

  void change_links(deed_reader& from, std::size_t whom) {
    switch (from.octet() & 3) {
    case 0: {
      const auto gone = std::exchange(links_[whom], {});
      if (gone)
        perform(whom, kernels_[whom].on_link_closed(*gone, now_));
      break;
    }
    case 1:
      if (!links_[whom])
        befriend(whom);
      break;
    case 2:
      part();
      break;
    case 3:
      if (!joined_)
        open_joint();
      break;
    }
    carry();
  }

  void part() {
    if (!std::exchange(joined_, false))
      return;
    wire_.clear();
    for (const int i : {0, 1})
      perform(idx(i), kernels_[idx(i)].on_link_closed(joint, now_));
  }

  void announce(deed_reader& from, std::size_t whom) {
    const auto who = from.octet();
    const auto good = peis::encode(peis::announcement{
        500, config_of(1).network.network, record_of(somebody[who & 15], (who & 16) != 0)});
    auto octets = good;
    if ((who & 32) != 0)
      octets[std::size_t{from.octet()} * 2] = from.octet();
    perform(whom, kernels_[whom].on_announcement(octets, now_));
    carry();
  }

  void expect(std::size_t who, peis::request_id request) { open_[who].insert({request, now_}); }

  /// Octets between the kernels arrive at once.
  void carry() {
    for (int turns = 0; !wire_.empty(); ++turns) {
      assert(turns < 100'000); // two kernels that never have done with each other
      const auto [to, octets] = std::move(wire_.front());
      wire_.pop_front();
      perform(to, kernels_[to].on_link_octets(joint, octets.view(), now_));
    }
  }

  void perform(std::size_t who, peis::outputs todo) {
    for (auto& x : todo)
      std::visit([&](auto& what) { handle(who, what); }, x);
  }

  void handle(std::size_t who, peis::to_link& x) {
    if (x.link == joint) {
      if (joined_)
        wire_.emplace_back(1 - who, std::move(x.octets));
      return;
    }
    if (links_[who] != x.link)
      return;
    heard_[who].feed(x.octets.view());
    while (const auto package = heard_[who].next()) {
      const auto& header = package->header;
      assert(peis::is_legal(header) || header.source == hostile);
      assert(header.hops <= peis::hops_max);
      if (header.reliable() && header.destination == hostile &&
          asked_[who].size() < peis::acknowledgements_max)
        asked_[who].push_back(header.ack_id);
    }
    assert(!heard_[who].broken());
  }
  void handle(std::size_t who, const peis::close_link& x) {
    if (x.link == joint)
      part();
    else if (links_[who] == x.link)
      links_[who].reset();
  }
  void handle(std::size_t who, const peis::connect_to& x) { failed_.emplace_back(who, x.attempt); }
  void handle(std::size_t who, const peis::outcome& x) {
    if (x.request != peis::no_request)
      assert(open_[who].erase(x.request) == 1);
  }
  template <class T>
  static void handle(std::size_t, const T&) {}

  void pass(duration length) {
    const auto end = now_ + length;
    for (int turns = 0; turns < 4000; ++turns) {
      for (const auto& [who, attempt] : std::exchange(failed_, {}))
        perform(who, kernels_[who].on_attempt_failed(attempt, now_));
      carry();
      std::optional<instant> next;
      for (const auto& kernel : kernels_)
        next = earliest(next, kernel.deadline());
      if (!next || *next > end)
        break;
      assert(turns < 3999 || length > 1s); // time does not pass
      now_ = std::max(now_, *next);
      for (const int i : {0, 1}) {
        const auto due = kernels_[idx(i)].deadline();
        if (due && *due <= now_)
          perform(idx(i), kernels_[idx(i)].on_time(now_));
      }
    }
    now_ = end;
    check();
  }

  /// A request has had its outcome after the last repeat; time passes only if one waits.
  void settle() {
    carry();
    for (int i = 0; i < 30 && !(open_[0].empty() && open_[1].empty()); ++i)
      pass(1s);
    assert(open_[0].empty() && open_[1].empty());
    check();
  }

  void check() const {
    for (const auto& kernel : kernels_) {
      for (const auto& link : kernel.network().links.views())
        assert(link.queued <= peis::lanes * config_of(1).network.queue.packages);
      assert(kernel.network().links.views().size() <= 2);
    }
  }

  instant now_{};
  std::array<peis::kernel, 2> kernels_;
  bool joined_ = false;
  std::deque<std::pair<std::size_t, payload>> wire_; ///< with the number of whom they go to
  std::array<std::optional<peis::link_id>, 2> links_;
  std::array<peis::stream_decoder, 2> heard_;      ///< what the hostile neighbour is told
  std::array<std::vector<std::int32_t>, 2> asked_; ///< to acknowledge
  std::array<std::map<peis::request_id, instant>, 2> open_;
  std::vector<std::pair<std::size_t, peis::attempt_id>> failed_;
  std::uint64_t next_link_ = 2;
  std::uint64_t last_request_ = 0;
  std::int32_t last_id_ = 0;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  arena all;
  all.run({data, size});
  return 0;
}
