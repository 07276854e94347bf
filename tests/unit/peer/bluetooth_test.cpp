// Kernels over the links of Bluetooth adapters, in whose place are local packet sockets: an address
// is a file there, and a made-up controller finds all of them.
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <sys/socket.h>
#include <sys/un.h>

#include "core/numbers/random.hpp"
#include "io/files/temporary_folder.hpp"
#include "peer/bluetooth_links.hpp"
#include "peis/kernel/kernel.hpp"
#include "peis/media/simulated_bluetooth.hpp"
#include "support/catch.hpp"

namespace rubicon::peer {
namespace {

using std::chrono::steady_clock;

constexpr peis::bluetooth_address robot_device{{2, 0x4b, 0, 0x1f, 0xa0, 7}};
constexpr peis::bluetooth_address pc_device{{2, 0x4b, 0, 0x1f, 0xa0, 8}};
constexpr peis::bluetooth_address phone_device{{2, 0, 0, 0, 0, 1}};

/// The air between adapters of this process.
struct local_medium {
  io::loop loop;
  io::temporary_folder folder{"rubicon-bluetooth"};
  std::map<peis::bluetooth_address, int> strengths_dbm; ///< of who can be seen
  std::vector<io::packet_stream> controllers;

  [[nodiscard]] sockaddr_un place_of(const io::bluetooth_octets& x, std::uint16_t port) const {
    sockaddr_un place{};
    place.sun_family = AF_UNIX;
    const auto path =
        (folder.path() / (to_string(peis::bluetooth_address{x}) + ';' + std::to_string(port)))
            .string();
    REQUIRE(path.size() < sizeof place.sun_path);
    std::copy(path.begin(), path.end(), place.sun_path);
    return place;
  }
};

class local_adapter : public io::bluetooth_adapter {
public:
  local_adapter(local_medium& medium, const peis::bluetooth_address& address)
      : medium_(&medium), address_(address) {}

  [[nodiscard]] io::bluetooth_octets address() const override { return address_.octets; }

  [[nodiscard]] opened listen(std::uint16_t port) override {
    io::descriptor x(::socket(AF_UNIX, type, 0));
    const auto here = medium_->place_of(address_.octets, port);
    if (::bind(x.get(), reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0 ||
        ::listen(x.get(), 8) != 0)
      return std::error_code(errno, std::system_category());
    return x;
  }

  [[nodiscard]] opened connect(const io::bluetooth_octets& to, std::uint16_t port) override {
    io::descriptor x(::socket(AF_UNIX, type, 0));
    const auto there = medium_->place_of(to, port);
    if (::connect(x.get(), reinterpret_cast<const sockaddr*>(&there), sizeof there) != 0)
      return std::error_code(errno, std::system_category());
    return x;
  }

  [[nodiscard]] opened open_controller() override {
    std::array<int, 2> ends{};
    REQUIRE(::socketpair(AF_UNIX, type, 0, ends.data()) == 0);
    auto& far = medium_->controllers.emplace_back(medium_->loop, io::descriptor(ends[1]), 100'000);
    const auto number = medium_->controllers.size() - 1;
    far.start({[this, number](byte_view x) { inquire(number, x); }, [](std::size_t) {},
               [](const std::string&) {}});
    return io::descriptor(ends[0]);
  }

private:
  static constexpr int type = SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK;

  void inquire(std::size_t number, byte_view command) {
    REQUIRE(to_hex(command.first(7)) == "01010405338b9e");
    auto& far = medium_->controllers[number];
    CHECK(far.send(*from_hex("040f0400010104")));
    for (const auto& [address, strength_dbm] : medium_->strengths_dbm) {
      if (address == address_)
        continue;
      bytes result = *from_hex("04220f01");
      result.insert(result.end(), address.octets.rbegin(), address.octets.rend());
      result.insert(result.end(), 7, 0);
      result.push_back(static_cast<std::uint8_t>(strength_dbm));
      CHECK(far.send(result));
    }
    CHECK(far.send(*from_hex("04010100")));
  }

  local_medium* medium_;
  peis::bluetooth_address address_;
};

/// A kernel with such an adapter, put together as actors/real_links does it.
class bluetooth_peer : private link_user, private adapter_user {
public:
  bluetooth_peer(local_medium& medium, std::int32_t id, const peis::bluetooth_address& address,
                 std::vector<std::string> always = {})
      : medium_(&medium) {
    bluetooth_links_config config;
    config.adapter = "hci0";
    config.hello_timeout = 200ms;
    config.first_link = peis::link_id{100};
    auto opened = bluetooth_links::open(
        medium.loop, config, std::make_unique<local_adapter>(medium, address), *this, *this);
    REQUIRE(std::holds_alternative<std::unique_ptr<bluetooth_links>>(opened));
    links_ = std::move(std::get<std::unique_ptr<bluetooth_links>>(opened));
    peis::kernel_config x;
    x.network.id = peer_id{id};
    x.network.host_name = "host" + std::to_string(id);
    x.network.bluetooth.adapters = {"hci0"};
    x.network.addresses = {links_->address()};
    x.network.link_window = bluetooth_links::window;
    x.network.connections.always = std::move(always);
    kernel_ = peis::kernel(x, random_stream(static_cast<std::uint64_t>(id), "peer"), now());
  }

  void step() {
    if (kernel_.deadline() && *kernel_.deadline() <= now())
      perform(kernel_.on_time(now()));
  }

  void perform(peis::outputs todo) {
    for (auto& each : todo)
      std::visit([this](auto& x) { handle(x); }, each);
  }

  [[nodiscard]] instant now() const { return instant(steady_clock::now() - start_); }
  [[nodiscard]] peis::kernel& kernel() { return kernel_; }
  [[nodiscard]] bluetooth_links& links() { return *links_; }
  [[nodiscard]] std::string value(const std::string& key) {
    for (const auto& x : kernel_.reader().own())
      if (x->name.text() == key)
        return std::string(x->text());
    return "none";
  }

  std::map<std::string, std::string> changed; ///< values that were received
  std::size_t largest = 0;

private:
  template <class Output>
  void handle(Output& x) {
    if constexpr (requires { links_->carry_out(x); }) {
      links_->carry_out(x);
    } else if constexpr (std::is_same_v<Output, peis::tuple_changed>) {
      changed[x.content->name.text()] = std::string(x.content->text());
      largest = std::max(largest, x.content->value.size());
    }
  }

  void on_link_open(peis::link_id link, peis::link_role role,
                    std::optional<peis::attempt_id> attempt) override {
    perform(kernel_.on_link_open(link, role, now(), attempt));
  }
  void on_attempt_failed(peis::attempt_id attempt, const std::string&) override {
    perform(kernel_.on_attempt_failed(attempt, now()));
  }
  void on_link_octets(peis::link_id link, byte_view octets) override {
    perform(kernel_.on_link_octets(link, octets, now()));
  }
  void on_link_sent(peis::link_id link, std::size_t octets) override {
    perform(kernel_.on_link_sent(link, octets, now()));
  }
  void on_link_closed(peis::link_id link, const std::string&) override {
    perform(kernel_.on_link_closed(link, now()));
  }
  void on_announcement(byte_view, const ipv4_address&) override {}
  void on_addresses() override {}
  void on_scan(const std::string& adapter, const std::vector<peis::seen_device>& seen) override {
    perform(kernel_.on_bluetooth_scan(adapter, seen, now()));
  }
  void on_hello(std::uint64_t number, byte_view octets) override {
    perform(kernel_.on_hello(octets, now()));
    links_->answer_hello(number, kernel_.network().own.hello());
  }
  void on_hello_answer(const std::string& adapter, const peis::bluetooth_address& device,
                       byte_view octets) override {
    perform(kernel_.on_hello_answer(adapter, device, octets, now()));
  }

  local_medium* medium_;
  steady_clock::time_point start_ = steady_clock::now();
  std::unique_ptr<bluetooth_links> links_;
  peis::kernel kernel_;
};

bool run(local_medium& medium, const std::vector<bluetooth_peer*>& all,
         const std::function<bool()>& done) {
  const auto end = steady_clock::now() + 20s;
  while (!done() && steady_clock::now() < end) {
    for (auto* x : all)
      x->step();
    medium.loop.wait_until(std::min(end, steady_clock::now() + 1ms));
  }
  return done();
}

std::string bluetooth_url(bluetooth_peer& x) {
  return to_string(peis::url_of(x.links().address()));
}

struct two_peers {
  local_medium medium;
  bluetooth_peer robot{medium, 1, robot_device};
  bluetooth_peer pc{medium, 2, pc_device, {bluetooth_url(robot)}};

  bool until(const std::function<bool()>& done) { return run(medium, {&robot, &pc}, done); }
  two_peers() {
    REQUIRE(until([&] {
      return robot.kernel().network().hosts.records().size() == 2 &&
             pc.kernel().network().hosts.records().size() == 2;
    }));
  }
};

/// A connection to an adapter of which a test knows every octet.
struct raw_device {
  io::packet_stream stream;
  std::vector<bytes> packets;
  bool closed = false;

  raw_device(local_medium& medium, const peis::bluetooth_address& to, std::uint16_t port) {
    auto x = local_adapter(medium, phone_device).connect(to.octets, port);
    REQUIRE(std::holds_alternative<io::descriptor>(x));
    stream = io::packet_stream(medium.loop, std::move(std::get<io::descriptor>(x)), 100'000);
    stream.start({[this](byte_view y) { packets.push_back(to_bytes(y)); }, [](std::size_t) {},
                  [this](const std::string&) { closed = true; }});
  }
};

} // namespace

TEST_CASE("two kernels exchange tuples over the links of adapters",
          "[peer][LNK-01][LNK-02][BT-02]") {
  two_peers p;
  CHECK(bluetooth_url(p.robot) == "bt://02:4B:00:1F:A0:07;8193");
  CHECK(p.pc.links().open_links() == 1);
  p.pc.perform(p.pc.kernel().subscriptions().subscribe(peer_id{1}, "room.*",
                                                       peis::subscription_id{1}, p.pc.now()));
  p.robot.perform(
      p.robot.kernel().tuples().set("room.lamp", peis::text_content("on"), p.robot.now()));
  CHECK(p.until([&] { return p.pc.changed["room.lamp"] == "on"; }));
  bytes big(1'000'000, 'x'); // goes through the bounded queues of a link
  p.robot.perform(
      p.robot.kernel().tuples().set("room.scan", peis::binary_content(big), p.robot.now()));
  CHECK(p.until([&] { return p.pc.largest == big.size(); }));
  CHECK(p.robot.links().counters().dropped == 0);
  p.robot.links().close_all();
  CHECK(p.until([&] { return p.pc.links().open_links() == 0; }));
}

TEST_CASE("each package is one packet, and so is the connect request", "[peer][LNK-06][BT-02]") {
  two_peers p;
  raw_device stranger(p.medium, robot_device, 8193);
  CHECK(stranger.stream.send(encode(peis::connect_request{500, peer_id{3}, 0, "default"})));
  CHECK(p.until([&] { return stranger.closed || stranger.packets.size() >= 2; }));
  CHECK_FALSE(stranger.packets.empty());
  for (const auto& each : stranger.packets) {
    const auto header = peis::decode_header(each);
    REQUIRE(header);
    CHECK(each.size() == peis::header_size + header->length);
  }
}

TEST_CASE("garbage over Bluetooth ends its own link only", "[peer][GEN-06][LNK-06]") {
  two_peers p;
  raw_device noise(p.medium, robot_device, 8193);
  raw_device question(p.medium, robot_device, peis::hello_port);
  random_stream rng(7, "noise");
  bytes garbage(1500);
  for (auto& each : garbage)
    each = static_cast<std::uint8_t>(rng.below(256));
  CHECK(noise.stream.send(garbage));
  CHECK(question.stream.send(garbage));
  CHECK(p.until([&] { return noise.closed && question.closed; }));
  raw_device silent(p.medium, robot_device, peis::hello_port);
  CHECK(p.until([&] { return silent.closed; }));
  std::vector<std::unique_ptr<raw_device>> crowd;
  for (std::size_t i = 0; i < bluetooth_hellos::hellos_max + 1; ++i) {
    crowd.push_back(std::make_unique<raw_device>(p.medium, robot_device, peis::hello_port));
    CHECK(p.until([&] { return true; }));
    p.medium.loop.poll();
  }
  CHECK(p.until([&] { return p.robot.links().counters().hellos_lost > 0; }));
  CHECK(p.robot.links().open_links() == 1);
  CHECK(p.pc.links().open_links() == 1);
}

TEST_CASE("peers find each other by scans and HELLOs", "[peer][BT-04][BT-05][BT-06]") {
  local_medium medium;
  medium.strengths_dbm = {{robot_device, -50}, {pc_device, -50}, {phone_device, -60}};
  bluetooth_peer robot(medium, 1, robot_device);
  bluetooth_peer pc(medium, 2, pc_device);
  CHECK(run(medium, {&robot, &pc}, [&] {
    return pc.value("kernel.hci0.02-4B-00-1F-A0-07.peis") == "yes" &&
           pc.value("kernel.hci0.02-00-00-00-00-01.peis") == "no";
  }));
  CHECK(pc.value("kernel.hci0.02-4B-00-1F-A0-07.str") == "-50");
  CHECK(run(medium, {&robot, &pc}, [&] {
    return robot.links().open_links() > 0 && robot.kernel().network().reachable(peer_id{2}) &&
           pc.kernel().network().reachable(peer_id{1});
  }));
}

TEST_CASE("of two peers at an adapter one answers HELLOs, and each has a port of its own",
          "[peer][BT-03]") {
  local_medium medium;
  bluetooth_peer first(medium, 1, robot_device);
  bluetooth_peer second(medium, 2, robot_device);
  CHECK(first.links().answers_hellos());
  CHECK_FALSE(second.links().answers_hellos());
  CHECK(bluetooth_url(second) == "bt://02:4B:00:1F:A0:07;8195");
}

TEST_CASE("attempts over Bluetooth fail with a reason", "[peer][LNK-07]") {
  struct listener : link_user, adapter_user {
    std::vector<std::string> failures;
    void on_link_open(peis::link_id, peis::link_role, std::optional<peis::attempt_id>) override {}
    void on_attempt_failed(peis::attempt_id, const std::string& why) override {
      failures.push_back(why);
    }
    void on_link_octets(peis::link_id, byte_view) override {}
    void on_link_sent(peis::link_id, std::size_t) override {}
    void on_link_closed(peis::link_id, const std::string&) override {}
    void on_announcement(byte_view, const ipv4_address&) override {}
    void on_addresses() override {}
    void on_scan(const std::string&, const std::vector<peis::seen_device>&) override {}
    void on_hello(std::uint64_t, byte_view) override {}
    void on_hello_answer(const std::string&, const peis::bluetooth_address&, byte_view) override {}
  } user;
  local_medium medium;
  auto opened =
      bluetooth_links::open(medium.loop, {.adapter = "hci0"},
                            std::make_unique<local_adapter>(medium, pc_device), user, user);
  auto& links = *std::get<std::unique_ptr<bluetooth_links>>(opened);
  links.carry_out(peis::connect_to{peis::attempt_id{1}, "bt://02:00:00:00:00:01;8193"});
  links.carry_out(peis::connect_to{peis::attempt_id{2}, "tcp://127.0.0.1:8000"});
  CHECK(user.failures.empty());
  medium.loop.poll();
  REQUIRE(user.failures.size() == 2);
  CHECK(user.failures[0].starts_with("bt://02:00:00:00:00:01;8193: "));
  CHECK(user.failures[1] == "tcp://127.0.0.1:8000: not an address of Bluetooth");
}

} // namespace rubicon::peer
