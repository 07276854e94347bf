// The real world of tests: programs of ours, a folder, and a cable that makes errors.
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/numbers/random.hpp"
#include "io/process/process.hpp"
#include "io/serial/pseudo_terminal.hpp"
#include "io/serial/serial_port.hpp"
#include "io/tcp/tcp_listener.hpp"
#include "serial/recording.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

namespace rubicon::test {

using nlohmann::json;

inline const std::string binary = RUBICON_BINARY;

/// Runs the loop until something is so; far too long a wait is a failure.
inline void run(io::loop& loop, const std::function<bool()>& done) {
  const auto end = std::chrono::steady_clock::now() + 90s;
  while (!done() && std::chrono::steady_clock::now() < end)
    loop.wait_until(std::chrono::steady_clock::now() + 20ms);
  REQUIRE(done());
}

/// A rubicon and all that it says.
struct program {
  program(io::loop& where, std::vector<std::string> words) : loop(where) {
    words.insert(words.begin(), "rubicon");
    auto x = io::process::start(loop, {.program = binary, .words = std::move(words)},
                                {[this](io::process::output from, byte_view octets) {
                                   auto& to = from == io::process::output::out ? out : err;
                                   to += to_string(octets);
                                 },
                                 [this](io::process_end how) { end = how; }});
    if (const auto* why = std::get_if<std::string>(&x))
      FAIL(*why);
    process = std::make_unique<io::process>(std::get<io::process>(std::move(x)));
  }

  void await_end() {
    run(loop, [this] { return end.has_value(); });
  }

  /// Ends a run as Ctrl-C does.
  json report() {
    process->signal(SIGINT);
    await_end();
    INFO(err);
    CHECK(err.empty());
    REQUIRE(end->status == 130);
    return json::parse(out);
  }

  io::loop& loop;
  std::string out;
  std::string err;
  std::optional<io::process_end> end;
  std::unique_ptr<io::process> process;
};

/// The real world of a test: a folder, and a cable.
struct edge {
  edge() {
    write("mote.toml", "[ecology]\nname = \"motes\"\nmode = \"wall\"\nduration = \"5min\"\n"
                       "[mote_type.climate]\ntype = 101\n"
                       "transducers.temperature = { model = \"sine\", mean = 24, amplitude = 3, "
                       "period = \"40s\", resolution = 0.1 }\n"
                       "apps = [{ app = \"sampler\", transducers = [\"temperature\"], "
                       "every = \"200ms\" }]\n"
                       "[[island]]\nid = 20\nname = \"kitchen\"\nserial = { pty = \"" +
                           file("sink") +
                           "\" }\n"
                           "mote = [{ id = 2, type = \"climate\", position_m = [1, 0] }, "
                           "{ id = 3, type = \"climate\", position_m = [0, 1] }]\n");
  }

  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
  }

  void write_gateway(const std::string& how) const {
    write("gateway.toml", "[ecology]\nname = \"gateway\"\nmode = \"wall\"\nduration = \"5min\"\n"
                          "[[island]]\nid = 20\nname = \"kitchen\"\n" +
                              how);
  }

  std::unique_ptr<program> start(const std::string& name) {
    return std::make_unique<program>(
        loop, std::vector<std::string>{"run", file(name + ".toml"), "--json", "--log", "off",
                                       "--record-serial", file(name + ".txt")});
  }

  /// Whatever has been recorded so far.
  [[nodiscard]] std::vector<serial::recorded_frame> recorded(const std::string& name) const {
    std::vector<serial::recorded_frame> all;
    std::ifstream in(file(name + ".txt"));
    for (std::string line; std::getline(in, line) && !in.eof();)
      if (auto x = serial::read_recorded(line); std::holds_alternative<serial::recorded_frame>(x))
        all.push_back(std::get<serial::recorded_frame>(std::move(x)));
    return all;
  }

  [[nodiscard]] std::vector<bytes> packets(const std::string& name,
                                           serial::direction towards) const {
    std::vector<bytes> found;
    for (auto& x : recorded(name))
      if (x.towards == towards && !x.what.packet.empty())
        found.push_back(std::move(x.what.packet));
    return found;
  }

  [[nodiscard]] std::size_t up(const std::string& name) const {
    return packets(name, serial::direction::to_pc).size();
  }

  test::scratch_folder folder;
  io::loop loop;
};

/// Packets that have come though nobody has sent them.
inline std::size_t strange(const std::vector<bytes>& come, const std::vector<bytes>& sent) {
  const std::set<bytes> known(sent.begin(), sent.end());
  return static_cast<std::size_t>(
      std::ranges::count_if(come, [&](const bytes& x) { return !known.contains(x); }));
}

/// A cable that changes one octet in a hundred, or in so many; 0: none.
class bad_cable {
public:
  explicit bad_cable(edge& where, std::uint64_t one_in = 100) : edge_(where), one_in_(one_in) {}

  void plug() {
    run(edge_.loop, [this] { return std::filesystem::is_symlink(edge_.file("sink")); });
    auto sink = io::serial_port::open(edge_.loop, edge_.file("sink"), 57600, room);
    auto pc = io::pseudo_terminal::open(edge_.loop, edge_.file("tty"), room);
    REQUIRE(std::holds_alternative<io::serial_port>(sink));
    REQUIRE(std::holds_alternative<io::pseudo_terminal>(pc));
    sink_.emplace(std::get<io::serial_port>(std::move(sink)));
    pc_.emplace(std::get<io::pseudo_terminal>(std::move(pc)));
    sink_->start({[this](byte_view x) { static_cast<void>(pc_->send(spoilt(x))); },
                  [](const std::string&) {}});
    pc_->start({[this](byte_view x) { static_cast<void>(sink_->send(spoilt(x))); }, [](bool) {}});
  }

  void unplug() {
    sink_.reset();
    pc_.reset();
  }

private:
  static constexpr std::size_t room = 4096;

  payload spoilt(byte_view octets) {
    auto out = to_bytes(octets);
    for (auto& x : out)
      if (one_in_ > 0 && rng_.below(one_in_) == 0)
        x = static_cast<std::uint8_t>(x ^ (1 + rng_.below(255)));
    return out;
  }

  edge& edge_;
  std::uint64_t one_in_;
  random_stream rng_{7};
  std::optional<io::serial_port> sink_;
  std::optional<io::pseudo_terminal> pc_;
};

/// Free a moment ago.
inline std::uint16_t free_port(io::loop& loop) {
  const auto x =
      io::tcp_listener::open(loop, "127.0.0.1", 0, [](io::tcp_stream, const ipv4_address&) {});
  return std::get<io::tcp_listener>(x).port();
}

} // namespace rubicon::test
