// A peer that measures, driven by lines on standard input; every answer is one line on standard
// output, `@ <monotonic seconds> <EVENT> <words>`:
//
//   (start)                                   READY id N port P [udp P]
//   monitor                                   MON known N routable N connections N, on each change;
//                                             DEAD ID
//   echo OWNER IN OUT                         sets OUT to each value of OWNER.IN
//   ping OWNER IN OUT COUNT SIZE GAP          PING n GOT of COUNT min_ms .. p50 .. p95 .. p99 ..
//                                             max ..
//   watch OWNER KEY, reset
//   stats                                     STATS n .. bytes .. gaps .. last .. secs ..
//                                             lat_min_ms .. p50 .. p95 .. p99 .. max ..
//                                             repeats ..; gaps: values skipped
//   count                                     COUNT n .., cheaper than stats
//   flood KEY SIZE COUNT RATE                 FLOODDONE n COUNT secs S; RATE 0: one each turn
//   overtaken                                 OVERTAKEN n .. given_up .. refused ..: values set
//   that
//                                             subscribers did not get, or that could not be set
//   quit                                      BYE
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <unistd.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "core/numbers/random.hpp"
#include "io/context.hpp"
#include "peer/standalone.hpp"

namespace {

using namespace rubicon;

double monotonic_s() {
  return seconds(std::chrono::steady_clock::now().time_since_epoch());
}

void tell(const std::string& event) {
  std::printf("@ %.6f %s\n", monotonic_s(), event.c_str());
  std::fflush(stdout);
}

std::string fixed(double x, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, x);
  return text.data();
}

std::string quantiles(std::vector<double> ms, const char* least) {
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double q) {
    const auto last = static_cast<double>(ms.size()) - 1;
    return ms.empty() ? std::string("nan") : fixed(ms[static_cast<std::size_t>(q * last)], 3);
  };
  return std::string(least) + ' ' + at(0) + " p50 " + at(0.5) + " p95 " + at(0.95) + " p99 " +
         at(0.99) + " max " + at(1);
}

peis::tuple_content value_of(const std::string& head, std::size_t size) {
  bytes octets = to_bytes(head);
  octets.resize(std::max(size, octets.size() + 1), '.');
  octets.back() = 0;
  peis::tuple_content x;
  x.value = std::move(octets);
  return x;
}

/// Lines of standard input, as events of the loop.
class line_reader {
public:
  line_reader(io::loop& where, std::function<void(std::string)> on_line,
              std::function<void()> on_end)
      : input_(io::context_of(where), ::dup(STDIN_FILENO)), on_line_(std::move(on_line)),
        on_end_(std::move(on_end)) {
    read();
  }

private:
  void read() {
    input_.async_read_some(boost::asio::buffer(piece_), [this](const auto& error, auto size) {
      if (error) {
        if (error != boost::asio::error::operation_aborted)
          on_end_();
        return;
      }
      for (std::size_t i = 0; i < size; ++i) {
        if (piece_[i] == '\n')
          on_line_(std::exchange(line_, {}));
        else
          line_ += piece_[i];
      }
      read();
    });
  }

  boost::asio::posix::stream_descriptor input_;
  std::array<char, 4096> piece_{};
  std::string line_;
  std::function<void(std::string)> on_line_;
  std::function<void()> on_end_;
};

struct flood {
  std::string key;
  std::size_t size = 0;
  std::uint64_t count = 0;
  double rate = 0;
  std::uint64_t sent = 0;
  double begun_s = monotonic_s();

  [[nodiscard]] double next_s() const {
    return rate == 0 ? 0 : begun_s + static_cast<double>(sent) / rate;
  }
};

struct ping {
  peer_id owner;
  std::string in;
  std::string out;
  std::uint64_t count = 0;
  std::size_t size = 0;
  double gap_s = 0;
  std::uint64_t number = 0; ///< of the one in flight
  bool waiting = false;
  double at_s = monotonic_s(); ///< when it left, or when the next one is due
  std::vector<double> ms;
};

struct watched {
  std::uint64_t values = 0;
  std::uint64_t octets = 0;
  std::uint64_t gaps = 0;    ///< values skipped
  std::uint64_t repeats = 0; ///< values that came after one as new
  std::int64_t last = -1;
  double first_s = 0;
  double last_s = 0;
  std::vector<double> ms;

  void on_value(const peis::tuple& x) {
    const auto now = monotonic_s();
    const std::string head(x.text().substr(0, 60));
    char* rest = nullptr;
    const auto number = std::strtoll(head.c_str(), &rest, 10);
    const auto written_s = std::strtod(rest, nullptr);
    if (last >= 0 && number > last + 1)
      gaps += static_cast<std::uint64_t>(number - last - 1);
    repeats += number <= last ? 1 : 0;
    last = number;
    first_s = values == 0 ? now : first_s;
    last_s = now;
    ++values;
    octets += x.value.size();
    ms.push_back((now - written_s) * 1e3);
  }
};

class bench {
public:
  bench(io::loop& loop, peer::standalone& peer)
      : peer_(&peer), reader_(
                          loop, [this](std::string x) { lines_.push_back(std::move(x)); },
                          [this] { over_ = true; }) {
    peer.on_host_change([this](peer_id host, bool is_there) {
      if (monitoring_ && !is_there)
        tell("DEAD " + to_string(host));
    });
  }

  void run() {
    while (!over_ && !peer_->quit_requested()) {
      peer_->step(wait());
      for (; !lines_.empty(); lines_.pop_front())
        perform(lines_.front());
      carry_on(monotonic_s());
      if (monitoring_)
        monitor();
    }
    peer_->leave();
    tell("BYE");
  }

private:
  /// Until the next thing that is ours to do.
  [[nodiscard]] duration wait() const {
    double until_s = monotonic_s() + 0.04;
    if (flood_)
      until_s = std::min(until_s, flood_->next_s());
    if (ping_ && !ping_->waiting)
      until_s = std::min(until_s, ping_->at_s);
    return std::max(duration{},
                    duration(static_cast<duration::rep>((until_s - monotonic_s()) * 1e9)));
  }

  void perform(const std::string& line) {
    std::istringstream words(line);
    std::string what;
    words >> what;
    if (what == "quit") {
      over_ = true;
    } else if (what == "monitor") {
      monitoring_ = true;
      last_monitored_.clear();
    } else if (what == "reset") {
      watched_ = {};
    } else if (what == "stats") {
      stats();
    } else if (what == "count") {
      tell("COUNT n " + std::to_string(watched_.values));
    } else if (what == "overtaken") {
      const auto counted = peer_->kernel().counters().tuples;
      tell("OVERTAKEN n " + std::to_string(counted.pushes_overtaken) + " given_up " +
           std::to_string(counted.pushes_given_up) + " refused " + std::to_string(refused_));
    } else if (what == "echo") {
      std::int32_t owner = 0;
      std::string in;
      std::string out;
      words >> owner >> in >> out;
      subscribe(peer_id{owner}, in, [this, out](const auto& x) {
        set(out, {x->value, x->mimetype, x->form, std::nullopt});
      });
    } else if (what == "watch") {
      std::int32_t owner = 0;
      std::string key;
      words >> owner >> key;
      subscribe(peer_id{owner}, key, [this](const auto& x) { watched_.on_value(*x); });
    } else if (what == "flood") {
      flood_.emplace();
      words >> flood_->key >> flood_->size >> flood_->count >> flood_->rate;
    } else if (what == "ping") {
      begin_ping(words);
    } else if (!what.empty()) {
      tell("ERROR unknown " + what);
    }
  }

  void begin_ping(std::istringstream& words) {
    auto& x = ping_.emplace();
    words >> x.owner.value >> x.in >> x.out >> x.count >> x.size >> x.gap_s;
    subscribe(x.owner, x.in, [this](const auto& answer) {
      if (!ping_ || !ping_->waiting || !answer->text().starts_with('P'))
        return;
      if (std::strtoull(std::string(answer->text().substr(1, 20)).c_str(), nullptr, 10) ==
          ping_->number) {
        ping_->ms.push_back((monotonic_s() - ping_->at_s) * 1e3);
        next_ping();
      }
    });
  }

  void next_ping() {
    ping_->waiting = false;
    ++ping_->number;
    ping_->at_s = monotonic_s() + ping_->gap_s * (0.5 + rng_.unit());
  }

  void carry_on(double now_s) {
    if (ping_ && ping_->waiting && now_s > ping_->at_s + 10)
      next_ping();
    if (ping_ && !ping_->waiting && ping_->number == ping_->count) {
      tell("PING n " + std::to_string(ping_->ms.size()) + " of " + std::to_string(ping_->count) +
           ' ' + quantiles(ping_->ms, "min_ms"));
      ping_.reset();
    } else if (ping_ && !ping_->waiting && now_s >= ping_->at_s) {
      ping_->waiting = true;
      ping_->at_s = monotonic_s();
      set(ping_->out, value_of('P' + std::to_string(ping_->number) + ' ', ping_->size));
    }
    while (flood_ && now_s >= flood_->next_s()) {
      set(flood_->key, value_of(std::to_string(flood_->sent) + ' ' + fixed(monotonic_s(), 6) + ' ',
                                flood_->size));
      const bool once = flood_->rate == 0;
      if (++flood_->sent == flood_->count) {
        tell("FLOODDONE n " + std::to_string(flood_->count) + " secs " +
             fixed(monotonic_s() - flood_->begun_s, 6));
        flood_.reset();
      }
      if (once)
        break;
    }
  }

  void subscribe(peer_id owner, const std::string& key, peer::tuple_callback changed) {
    const auto x = peer_->tuples().subscribe(owner, key, std::move(changed));
    if (const auto* why = std::get_if<peis::cause>(&x))
      tell("ERROR subscribe " + std::string(peis::to_string(*why)));
  }

  void set(const std::string& key, peis::tuple_content x) {
    const auto why = peer_->tuples().set(key, std::move(x));
    if (why == peis::cause::none)
      return;
    ++refused_;
    tell("ERROR set " + std::string(peis::to_string(why)));
  }

  void stats() {
    const auto& x = watched_;
    tell("STATS n " + std::to_string(x.values) + " bytes " + std::to_string(x.octets) + " gaps " +
         std::to_string(x.gaps) + " last " + std::to_string(x.last) + " secs " +
         fixed(x.last_s - x.first_s, 6) + ' ' + quantiles(x.ms, "lat_min_ms") + " repeats " +
         std::to_string(x.repeats));
  }

  void monitor() {
    const auto hosts = peer_->network().hosts.records();
    const auto routable = std::count_if(hosts.begin(), hosts.end(), [&](const auto* x) {
      return x->id != peer_->kernel().id() && peer_->network().reachable(x->id);
    });
    auto news = "MON known " + std::to_string(hosts.size()) + " routable " +
                std::to_string(routable) + " connections " +
                std::to_string(peer_->links().open_links());
    if (news == last_monitored_)
      return;
    tell(news);
    last_monitored_ = std::move(news);
  }

  peer::standalone* peer_;
  line_reader reader_;
  std::deque<std::string> lines_;
  bool over_ = false;
  bool monitoring_ = false;
  std::string last_monitored_;
  std::uint64_t refused_ = 0; ///< values that could not be set
  std::optional<flood> flood_;
  std::optional<ping> ping_;
  watched watched_;
  random_stream rng_{1};
};

/// @returns the value of an option with a number, or ends the program
template <class T>
T number(std::string_view option, std::string_view text) {
  T x{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc{} || stop != text.data() + text.size()) {
    std::cerr << "not a number: " << option << ' ' << text << '\n';
    std::exit(2);
  }
  return x;
}

constexpr const char* usage =
    "usage: peis_bench_peer --peis-id N [--peis-hostname S] [--peis-port N] [--peis-network S]\n"
    "         [--peis-connect tcp://HOST:PORT]... [--lan] [--udp] [--address ADDRESS]\n"
    "         [--interface ADDRESS]\n"
    "Without --lan it does not announce itself, and stays on loopback or --address.\n";

} // namespace

int main(int argc, char* argv[]) {
  peer::standalone_config config;
  auto& network = config.kernel.network;
  network.name = "peis_bench_peer";
  std::vector<std::string> connect;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (option == "--lan") {
      config.links.lan = true;
      continue;
    }
    if (option == "--udp") {
      config.links.udp = true;
      continue;
    }
    if (++i == argc) {
      std::cerr << usage;
      return 2;
    }
    const std::string_view value = argv[i];
    if (option == "--peis-id")
      network.id = peer_id{number<std::int32_t>(option, value)};
    else if (option == "--peis-hostname")
      network.host_name = value;
    else if (option == "--peis-network")
      network.network = value;
    else if (option == "--peis-port")
      config.links.first_port = number<std::uint16_t>(option, value);
    else if (option == "--peis-connect")
      connect.emplace_back(value);
    else if (option == "--address")
      config.links.listen_address = value;
    else if (option == "--interface")
      config.links.group.interfaces = {std::string(value)};
    else {
      std::cerr << usage;
      return 2;
    }
  }
  if (network.id.value < 1 || network.id.value > peer_id_max) {
    std::cerr << usage;
    return 2;
  }
  network.connections.always = connect;
  config.on_warning = [](const std::string& x) { std::cerr << x << '\n'; };
  io::loop loop;
  auto opened = peer::standalone::open(loop, config);
  if (const auto* refusal = std::get_if<std::string>(&opened)) {
    std::cerr << *refusal << '\n';
    return 1;
  }
  auto& peer = *std::get<std::unique_ptr<peer::standalone>>(opened);
  bench all(loop, peer);
  tell("READY id " + to_string(network.id) + " port " + std::to_string(*peer.links().port()) +
       (peer.links().udp_port() ? " udp " + std::to_string(*peer.links().udp_port()) : ""));
  all.run();
}
