// What the PEIS room carries: two kernels in one thread, and peers as processes over loopback TCP.
//
// usage: bench_peis [--long] [--json] [SECTION...]    none: all
// Sections: kernels throughput paced latency idle discovery death. --long: paced ones take 60 s
// each instead of 10 s. --json: all figures once more, for programs.
//
// "Lost" are values that never reached the subscriber: a tuple holds the latest one, so a peer that
// cannot keep up may skip some. Flat out one value is set each turn of the publisher's loop; what
// the highest lossless rate is, rates tell at which it sets as many a turn as are due.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <exception>
#include <functional>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "bench_peers.hpp"
#include "calibration.hpp"
#include "core/numbers/random.hpp"
#include "figures.hpp"
#include "peis/kernel/kernel.hpp"

namespace {

using namespace rubicon;
using bench::aim;
using bench::at_least;
using bench::at_most;
using bench::bench_peers;
using bench::cpu_s;
using bench::figures;
using bench::wall_s;

struct load {
  const char* name;
  std::size_t octets;
  std::uint64_t in_process; ///< values
  std::uint64_t over_tcp;   ///< values
};
constexpr std::array<load, 5> loads = {{{"64 B", 64, 400'000, 300'000},
                                        {"1 KiB", 1024, 200'000, 150'000},
                                        {"100 KiB", 100 << 10, 10'000, 5'000},
                                        {"1 MiB", 1 << 20, 1'000, 500},
                                        {"10 MiB", 10 << 20, 50, 50}}};
constexpr double mb = 1e6;

// Two kernels in one thread.

/// Two kernels joined by a link that takes no time and loses nothing.
class kernel_pair {
public:
  kernel_pair() {
    for (int i = 0; i < 2; ++i) {
      peis::kernel_config x;
      x.network.id = peer_id{i + 1};
      x.network.host_name = "bench";
      x.network.connections.announces = false;
      kernels_[static_cast<std::size_t>(i)] =
          peis::kernel(x, random_stream(static_cast<std::uint64_t>(i + 1)), now_);
    }
    perform(1, kernels_[1].on_link_open(link, peis::link_role::acceptor, now_));
    perform(0, kernels_[0].on_link_open(link, peis::link_role::initiator, now_));
    pass(5s, 100ms);
    perform(1,
            kernels_[1].subscriptions().subscribe(peer_id{1}, "x", peis::subscription_id{1}, now_));
    pass(100ms, 10ms);
  }

  void set(const payload& value) {
    perform(0, kernels_[0].tuples().set("x", peis::binary_content(value), now_));
  }

  void run() {
    for (; !wire_.empty(); wire_.pop_front()) {
      const auto [to, octets] = wire_.front();
      perform(to, kernels_[to].on_link_octets(link, octets.view(), now_));
    }
  }

  void pass(duration time, duration step) {
    for (const auto end = now_ + time; now_ < end;) {
      run();
      now_ += step;
      for (std::size_t i = 0; i < 2; ++i) {
        if (const auto due = kernels_[i].deadline(); due && *due <= now_)
          perform(i, kernels_[i].on_time(now_));
      }
    }
    run();
  }

  [[nodiscard]] std::uint64_t received() const { return received_; }

private:
  static constexpr peis::link_id link{1};

  void perform(std::size_t who, peis::outputs todo) {
    for (auto& x : todo) {
      if (auto* sent = std::get_if<peis::to_link>(&x))
        wire_.emplace_back(1 - who, std::move(sent->octets));
      else if (std::holds_alternative<peis::tuple_changed>(x))
        ++received_;
    }
  }

  instant now_{};
  std::array<peis::kernel, 2> kernels_;
  std::deque<std::pair<std::size_t, payload>> wire_; ///< with the number of whom they go to
  std::uint64_t received_ = 0;
};

void measure_kernels(figures& out, bool) {
  const auto calibration = bench::calibrate();
  out.add("calibration", calibration, 1, "Mstep/s");
  for (const auto& x : loads) {
    kernel_pair all;
    const payload value(bytes(x.octets, 'x'));
    const std::uint64_t batch = x.octets > 10'000 ? 1 : 32;
    const auto before = all.received();
    const auto begun_s = cpu_s();
    for (std::uint64_t i = 0; i < x.in_process; i += batch) {
      for (std::uint64_t k = 0; k < batch; ++k)
        all.set(value);
      all.pass(100us, 100us);
    }
    all.pass(1s, 10ms);
    const auto took_s = cpu_s() - begun_s;
    const auto got = static_cast<double>(all.received() - before);
    const std::string name = x.name;
    out.add(name + ": updates", got / took_s, 0, "/s");
    out.add(name + ": ratio", got / took_s / calibration, 2, "/Mstep");
    out.add(name + ": values", got * static_cast<double>(x.octets) / took_s / mb, 1, "MB/s");
    out.add(name + ": lost", static_cast<double>(x.in_process) - got, 0, "", at_most(0));
  }
}

// Peers over TCP. 100 publishes, 101 subscribes.

struct flow {
  bench::event stats; ///< of the subscriber
  double lost = 0;

  [[nodiscard]] double per_s() const { return (stats.number("n") - 1) / stats.number("secs"); }
  [[nodiscard]] double mb_per_s() const {
    return per_s() * stats.number("bytes") / stats.number("n") / mb;
  }
};

/// Sets a tuple `count` times and waits until all values have come, or none has for 5 s.
/// @param rate a second; 0: as fast as it goes
flow measure_flow(std::size_t octets, std::uint64_t count, double rate) {
  bench_peers peers(2);
  auto& publisher = peers[0];
  auto& subscriber = peers[1];
  peers.wait_complete(10);
  const auto received = [&](double least) {
    return peers.ask(subscriber, "count", "COUNT", 20).number("n") >= least;
  };
  subscriber.send("watch 100 flow");
  publisher.send("flood flow 64 1 0");
  for (const auto end_s = wall_s() + 10; !received(1); peers.wait(0.05)) {
    if (wall_s() > end_s)
      throw std::runtime_error("the subscription has no effect");
  }
  peers.wait(1); // what belongs to the beginning is over
  subscriber.send("reset");
  static_cast<void>(received(0)); // so it has been done

  const auto size = std::to_string(octets);
  publisher.send("flood flow " + size + ' ' + std::to_string(count) + ' ' + std::to_string(rate));
  const auto begun_s = wall_s();
  const auto limit_s = 60 + (rate > 0 ? static_cast<double>(count) / rate : 0);
  double latest = 0;
  for (auto latest_s = begun_s; wall_s() < latest_s + 5 && wall_s() < begun_s + limit_s;) {
    peers.wait(0.1);
    const auto n = peers.ask(subscriber, "count", "COUNT", 20).number("n");
    if (n >= static_cast<double>(count))
      break;
    latest_s = n > latest ? wall_s() : latest_s;
    latest = n;
  }
  flow x;
  x.stats = peers.ask(subscriber, "stats", "STATS", 20);
  x.lost = static_cast<double>(count) - x.stats.number("n") + x.stats.number("repeats");
  if (x.stats.number("n") < 2)
    throw std::runtime_error("fewer than two values came");
  return x;
}

/// One figure that may fail without the others.
void attempt(figures& out, const std::string& what, const std::function<void()>& measure) {
  try {
    measure();
  } catch (const std::exception& error) {
    out.failure(what, error.what());
  }
}

/// The highest of these rates a second at which nothing is lost in one of two tries of 2 s; 0:
/// none.
double lossless_rate(std::size_t octets, std::initializer_list<int> rates) {
  double best = 0;
  for (const auto rate : rates) {
    const auto carries = [&] {
      const auto x = measure_flow(octets, static_cast<std::uint64_t>(2 * rate), rate);
      return x.lost == 0 && x.per_s() > 0.9 * rate;
    };
    if (!carries() && !carries())
      break;
    best = rate;
  }
  return best;
}

void measure_throughput(figures& out, bool) {
  for (const auto& x : loads) {
    const std::string name = x.name;
    attempt(out, name, [&] {
      const auto all = measure_flow(x.octets, x.over_tcp, 0);
      out.add(name + ": updates", all.per_s(), 0, "/s");
      out.add(name + ": values", all.mb_per_s(), 1, "MB/s",
              x.octets == 100 << 10 ? std::optional(at_least(200)) : std::nullopt);
      out.add(name + ": lost of " + std::to_string(x.over_tcp), all.lost, 0, "");
    });
  }
  attempt(out, "64 B: highest lossless rate", [&] {
    const auto rate = lossless_rate(64, {60'000, 80'000, 100'000, 120'000, 150'000});
    out.add("64 B: highest lossless rate", rate, 0, "/s", at_least(100'000));
  });
  attempt(out, "100 KiB: highest lossless rate", [&] {
    const auto rate = lossless_rate(100 << 10, {1'000, 1'500, 2'000, 2'500, 3'000});
    out.add("100 KiB: highest lossless rate", rate * (100 << 10) / mb, 1, "MB/s", at_least(200));
  });
}

void measure_paced(figures& out, bool thorough) {
  const int s = thorough ? 60 : 10;
  for (const auto& [name, octets, rate] :
       {std::tuple{"10 MiB at 10 Hz", 10 << 20, 10}, {"1 MiB at 25 Hz", 1 << 20, 25}}) {
    const std::string what = name;
    attempt(out, what, [&, octets = octets, rate = rate] {
      const auto all = measure_flow(static_cast<std::size_t>(octets),
                                    static_cast<std::uint64_t>(rate * s), rate);
      out.add(what + ": updates", all.per_s(), 2, "/s");
      out.add(what + ": one way p50", all.stats.number("p50"), 1, "ms");
      out.add(what + ": lost of " + std::to_string(rate * s), all.lost, 0, "", at_most(0));
    });
  }
}

void measure_latency(figures& out, bool) {
  attempt(out, "20/s", [&] {
    const auto all = measure_flow(64, 200, 20);
    out.add("20/s: one way p50", all.stats.number("p50") * 1e3, 0, "us", at_most(150));
    out.add("20/s: one way p99", all.stats.number("p99") * 1e3, 0, "us");
    out.add("20/s: lost of 200", all.lost, 0, "", at_most(0));
  });
  attempt(out, "50 000/s", [&] {
    const auto all = measure_flow(64, 250'000, 50'000);
    out.add("50 000/s: updates", all.per_s(), 0, "/s");
    out.add("50 000/s: one way p50", all.stats.number("p50") * 1e3, 0, "us", at_most(30));
    out.add("50 000/s: one way p99", all.stats.number("p99") * 1e3, 0, "us");
    out.add("50 000/s: lost of 250 000", all.lost, 0, "", at_most(0));
  });
  attempt(out, "round trip", [&] {
    bench_peers peers(2);
    peers.wait_complete(10);
    peers[1].send("echo 100 ping pong");
    peers.wait(1);
    const auto x = peers.ask(peers[0], "ping 101 pong ping 300 64 0.02", "PING", 60);
    out.add("round trip p50", x.number("p50") * 1e3, 0, "us");
    out.add("round trip p99", x.number("p99") * 1e3, 0, "us");
    out.add("round trip: unanswered of 300", 300 - x.number("n"), 0, "", at_most(0));
  });
}

void measure_idle(figures& out, bool) {
  attempt(out, "idle", [&] {
    bench_peers peers(2);
    peers.wait_complete(10);
    peers.wait(3);
    const auto begun_s = wall_s();
    const std::array used_s = {peers[0].processor_s(), peers[1].processor_s()};
    peers.wait(10);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto share = (peers[i].processor_s() - used_s[i]) / (wall_s() - begun_s);
      const auto name = "peer " + std::to_string(peers[i].id());
      out.add(name + ": processor", share * 100, 3, "%", at_most(0.5));
      out.add(name + ": resident, shared too", peers[i].memory_kib("Rss:"), 0, "KiB");
      out.add(name + ": proportional share", peers[i].memory_kib("Pss:"), 0, "KiB");
    }
  });
}

void measure_discovery(figures& out, bool) {
  for (const int count : {2, 5, 10, 20}) {
    const auto name = std::to_string(count) + " peers";
    attempt(out, name, [&] {
      bench_peers peers(count);
      peers.wait_complete(30);
      double last_s = 0;
      for (std::size_t i = 0; i < peers.size(); ++i)
        last_s = std::max(last_s, peers[i].complete(count)->at_s);
      out.add(name + ": all reach all", last_s - peers.started_s(), 3, "s",
              count == 20 ? std::optional(at_most(3)) : std::nullopt);
    });
  }
}

/// Kills one of five and tells when the others give it up.
void measure_death_of(figures& out, const std::string& name, std::size_t victim) {
  bench_peers peers(5);
  peers.wait_complete(20);
  peers.wait(3);
  const auto id = std::to_string(peers[victim].id());
  const auto killed_s = wall_s();
  peers[victim].kill();
  const auto when = [&](const std::function<bool(const bench::event&)>& noticed) {
    std::vector<double> all;
    for (std::size_t i = 0; i < peers.size(); ++i) {
      const auto& heard = peers[i].heard();
      const auto found = std::find_if(heard.begin(), heard.end(), [&](const bench::event& x) {
        return x.at_s >= killed_s && noticed(x);
      });
      if (found != heard.end())
        all.push_back(found->at_s - killed_s);
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto no_way = [](const bench::event& x) {
    return x.name == "MON" && x.number("routable") <= 3;
  };
  const auto dead = [&](const bench::event& x) { return x.name == "DEAD" && x.words.at(0) == id; };
  if (!peers.wait(30, [&] { return when(dead).size() == 4 && when(no_way).size() == 4; }))
    throw std::runtime_error(std::to_string(when(no_way).size()) + " of 4 lost the way, " +
                             std::to_string(when(dead).size()) + " gave it up, in 30 s");
  out.add(name + ": last without a way", when(no_way).back(), 3, "s");
  out.add(name + ": first DEAD", when(dead).front(), 3, "s");
  out.add(name + ": last DEAD", when(dead).back(), 3, "s", at_most(5));
}

void measure_death(figures& out, bool) {
  attempt(out, "the last of 5", [&] { measure_death_of(out, "the last of 5", 4); });
  attempt(out, "the first of 5", [&] { measure_death_of(out, "the first of 5", 0); });
}

struct section {
  const char* name;
  const char* what;
  void (*measure)(figures& out, bool thorough);
};
constexpr std::array<section, 7> sections = {
    {{"kernels", "two kernels in one thread, by its processor time", measure_kernels},
     {"throughput", "two processes over loopback TCP, one value each turn of the loop",
      measure_throughput},
     {"paced", "the same at a rate", measure_paced},
     {"latency", "64 B, two processes", measure_latency},
     {"idle", "two linked peers that do nothing, for 10 s", measure_idle},
     {"discovery",
      "peers started at once that are told of the first one only, since the last start",
      measure_discovery},
     {"death", "5 peers, one killed", measure_death}}};

int refuse(const std::string& word) {
  std::fprintf(stderr, "bench_peis: '%s' is neither --long, --json nor a section:", word.c_str());
  for (const auto& x : sections)
    std::fprintf(stderr, " %s", x.name);
  std::fprintf(stderr, "\n");
  return 2;
}

} // namespace

int main(int argc, char** argv) {
  bool thorough = false;
  bool json = false;
  std::vector<std::string> wanted;
  for (const std::string& word : std::vector<std::string>(argv + 1, argv + argc)) {
    const auto is_section = [&](const auto& x) { return x.name == word; };
    if (word == "--long")
      thorough = true;
    else if (word == "--json")
      json = true;
    else if (std::any_of(sections.begin(), sections.end(), is_section))
      wanted.push_back(word);
    else
      return refuse(word);
  }
  figures out;
  for (const auto& x : sections) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), x.name) == wanted.end())
      continue;
    out.section(x.name, x.what);
    x.measure(out, thorough);
  }
  if (json)
    out.print_json();
  return out.failures() == 0 ? 0 : 1;
}
