// What a gateway adds to a frame: from its last octet on the serial side to the tuple at a
// subscriber on the same computer. The gateway is a process of its own; this one is its sink, on a
// pseudo-terminal, and the subscriber, a peer over TCP on loopback.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "figures.hpp"
#include "io/process/process.hpp"
#include "io/serial/pseudo_terminal.hpp"
#include "io/tcp/tcp_listener.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "network/sink_event.hpp"
#include "peer/standalone.hpp"
#include "serial/frame.hpp"
#include "serial/packet.hpp"
#include "support/scratch_folder.hpp"
#include "support/segments.hpp"

namespace {

using namespace rubicon;
using bench::at_most;
using steady = std::chrono::steady_clock;

constexpr int readings = 2000;
constexpr island_id kitchen{20};
constexpr mote_id mote{2};

template <class T, class Found>
T taken(Found found) {
  if (const auto* why = std::get_if<std::string>(&found))
    throw std::runtime_error(*why);
  return std::get<T>(std::move(found));
}

std::uint16_t free_port(io::loop& loop) {
  return taken<io::tcp_listener>(io::tcp_listener::open(loop, "127.0.0.1", 0,
                                                        [](io::tcp_stream, const ipv4_address&) {}))
      .port();
}

class gateway_under_test {
public:
  gateway_under_test() : port_(free_port(loop_)) {
    const auto tty = folder_.file("sink");
    terminal_ = taken<io::pseudo_terminal>(io::pseudo_terminal::open(loop_, tty, 65536));
    terminal_.start({[this](byte_view x) { ack(x); }, [this](bool x) { attached_ = x; }});
    std::ofstream(folder_.file("gateway.toml"))
        << "[ecology]\nname = 'gateway'\nmode = 'wall'\nduration = '1h'\n"
           "[[island]]\nid = 20\nname = 'kitchen'\nserial.device = '"
        << tty
        << "'\n[[peer]]\nid = 11\nname = 'pc'\nlinks = ['inproc://kitchen-gateway']\n"
           "tcp = { port = "
        << port_ << " }\n";
    process_ = std::make_unique<io::process>(taken<io::process>(io::process::start(
        loop_,
        {.program = RUBICON_BINARY,
         .words = {"rubicon", "run", folder_.file("gateway.toml"), "--log", "off"}},
        {[](io::process::output, byte_view octets) {
           std::fwrite(octets.data(), 1, octets.size(), stderr);
         },
         [](io::process_end) {}})));
    peer::standalone_config config;
    config.kernel.network.id = peer_id{77};
    config.kernel.network.name = "subscriber";
    config.kernel.network.network = "rubicon";
    config.kernel.network.connections.always = {"tcp://127.0.0.1:" + std::to_string(port_)};
    config.links.first_port.reset();
    peer_ =
        taken<std::unique_ptr<peer::standalone>>(peer::standalone::open(loop_, std::move(config)));
    await([this] { return attached_ && peer_->network().reachable(gateway_of(kitchen)); });
    static_cast<void>(
        peer_->tuples().subscribe(gateway_of(kitchen), "devices.2.output.1",
                                  [this](const peis::tuple_pointer& x) { on_tuple(*x); }));
    say(network::am::sink_event,
        encode(network::sink_event(network::mote_joined{mote, 1, 101, {}})));
    for (int i = 0; !measure(0); ++i)
      if (i == 30)
        throw std::runtime_error("no tuple comes of what the sink says");
  }

  /// From the frame's last octet to the tuple.
  std::optional<duration> measure(std::uint16_t number) {
    got_.reset();
    wanted_ = number;
    const auto begun = steady::now();
    const bytes value{static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number)};
    say(network::am::to_gateway, encode(network::island_packet{
                                     own_island, no_mote, 1, encode(test::plain(mote, 1, value))}));
    static_cast<void>(peer_->run_until([this] { return got_.has_value(); }, 1s));
    if (!got_)
      return {};
    return std::chrono::duration_cast<duration>(*got_ - begun);
  }

  void rest() { peer_->step(2ms); }

private:
  template <class Condition>
  void await(Condition x) {
    if (!peer_->run_until(x, 30s))
      throw std::runtime_error("the gateway does not come up");
  }

  void say(std::uint8_t am_type, bytes octets) {
    serial::am_packet x;
    x.source = 1;
    x.group = static_cast<std::uint8_t>(kitchen.value);
    x.am_type = am_type;
    x.payload = std::move(octets);
    static_cast<void>(terminal_.send(
        serial::encode(serial::frame{serial::frame_type::packet, 0, serial::encode(x)})));
  }

  void ack(byte_view octets) {
    for (const auto octet : octets)
      if (const auto x = decoder_.on_octet(octet);
          x && x->type == serial::frame_type::packet_with_ack)
        static_cast<void>(terminal_.send(
            serial::encode(serial::frame{serial::frame_type::ack, x->sequence, {}})));
  }

  void on_tuple(const peis::tuple& x) {
    const auto value = x.value.view();
    if (value.size() == 2 && (value[0] << 8 | value[1]) == wanted_)
      got_ = steady::now();
  }

  test::scratch_folder folder_;
  io::loop loop_;
  std::uint16_t port_ = 0;
  io::pseudo_terminal terminal_;
  bool attached_ = false;
  serial::frame_decoder decoder_;
  std::unique_ptr<io::process> process_;
  std::unique_ptr<peer::standalone> peer_;
  int wanted_ = -1;
  std::optional<steady::time_point> got_;
};

double quantile_ms(const std::vector<duration>& sorted, double part) {
  const auto at = static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1));
  return 1e3 * seconds(sorted[at]);
}

} // namespace

int main(int argc, char** argv) {
  const bool json = argc == 2 && std::string(argv[1]) == "--json";
  if (argc > 1 && !json) {
    std::fprintf(stderr, "usage: bench_serial [--json]\n");
    return 2;
  }
  bench::figures out;
  try {
    gateway_under_test gateway;
    std::vector<duration> all;
    int lost = 0;
    for (int i = 1; i <= readings; ++i) {
      if (const auto took = gateway.measure(static_cast<std::uint16_t>(i)))
        all.push_back(*took);
      else
        ++lost;
      gateway.rest();
    }
    std::ranges::sort(all);
    out.section("a frame's way through a gateway",
                "from its last octet at the port to the tuple at a peer of the same computer");
    out.add("lost", lost, 0, "", at_most(0));
    if (!all.empty()) {
      out.add("median", quantile_ms(all, 0.5), 3, "ms", at_most(0.5));
      out.add("99 %", quantile_ms(all, 0.99), 3, "ms", at_most(5));
      out.add("slowest", quantile_ms(all, 1), 3, "ms");
    }
  } catch (const std::exception& error) {
    out.failure("the gateway", error.what());
  }
  if (json)
    out.print_json();
  return out.failures() == 0 ? 0 : 1;
}
