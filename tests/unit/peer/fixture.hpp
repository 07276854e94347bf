// Peers over loopback TCP, on one loop, and a counterpart that speaks captured octets.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/loop.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "peer/standalone.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

namespace rubicon::peer::test {

/// What is to happen soon must not take longer; a test that waits that long has failed.
inline constexpr duration patience = 20s;

inline standalone_config config_of(std::int32_t id) {
  standalone_config x;
  x.kernel.network.id = peer_id{id};
  x.kernel.network.host_name = "host" + std::to_string(id);
  x.links.first_port = 0; // any free one
  x.seed = static_cast<std::uint64_t>(id);
  return x;
}

inline std::unique_ptr<standalone> open(io::loop& loop, standalone_config config) {
  auto x = standalone::open(loop, std::move(config));
  REQUIRE(std::holds_alternative<std::unique_ptr<standalone>>(x));
  return std::get<std::unique_ptr<standalone>>(std::move(x));
}

inline std::string url_of(const standalone& x) {
  return "tcp://127.0.0.1:" + std::to_string(x.links().port().value());
}

/// Steps all of them until something has happened.
inline bool run(const std::vector<standalone*>& all, const std::function<bool()>& done) {
  const auto end = all.front()->now() + patience;
  while (!done() && all.front()->now() < end) {
    for (auto* x : all)
      x->step(1ms);
  }
  return done();
}

/// A package as it lies in the stream, cut by this file's own hands (peis-wire.md 6).
struct raw_package {
  bytes octets;

  [[nodiscard]] std::uint32_t word(std::size_t at) const {
    return static_cast<std::uint32_t>(octets.at(at)) << 24 |
           static_cast<std::uint32_t>(octets.at(at + 1)) << 16 |
           static_cast<std::uint32_t>(octets.at(at + 2)) << 8 | octets.at(at + 3);
  }
  [[nodiscard]] unsigned half(std::size_t at) const {
    return static_cast<unsigned>(octets.at(at) << 8 | octets.at(at + 1));
  }
  [[nodiscard]] unsigned port() const { return half(28); }
  [[nodiscard]] std::uint32_t source() const { return word(20); }
  [[nodiscard]] std::string text(std::size_t at) const {
    return {reinterpret_cast<const char*>(octets.data()) + at};
  }
};

/// One TCP connection of which a test knows every octet.
class raw_peer {
public:
  raw_peer(io::loop& loop, const standalone& to)
      : attempt_(loop, "127.0.0.1", to.links().port().value(), patience, [this](auto x) {
          if (auto* connected = std::get_if<io::tcp_stream>(&x)) {
            stream_ = std::move(*connected);
            stream_.start({[this](byte_view y) { in_.insert(in_.end(), y.begin(), y.end()); },
                           [](std::size_t) {}, [this](const std::string&) { closed_ = true; }});
            open_ = true;
          }
        }) {}

  void send(bytes x) { stream_.send(std::move(x)); }
  /// Octets of tests/golden/peis.
  void say(const std::string& file) { send(rubicon::test::read_hex_file("peis/" + file + ".hex")); }
  void drop() { stream_ = {}; }

  [[nodiscard]] bool open() const { return open_; }
  [[nodiscard]] bool closed() const { return closed_; }

  [[nodiscard]] std::vector<raw_package> packages() const {
    std::vector<raw_package> all;
    for (std::size_t at = 0; at + 40 <= in_.size();) {
      const auto size = 40U + (static_cast<std::size_t>(in_[at + 30]) << 8 | in_[at + 31]);
      if (at + size > in_.size())
        break;
      const auto from = in_.begin() + static_cast<std::ptrdiff_t>(at);
      all.push_back({bytes(from, from + static_cast<std::ptrdiff_t>(size))});
      REQUIRE(all.back().word(0) == 0xff00aa00);
      at += size;
    }
    return all;
  }
  [[nodiscard]] std::optional<raw_package> last(unsigned port) const {
    std::optional<raw_package> found;
    for (auto& x : packages()) {
      if (x.port() == port)
        found = std::move(x);
    }
    return found;
  }

  /// Has it got an acknowledgement of that number (peis-wire.md 8.2)?
  [[nodiscard]] bool has_acknowledged(std::uint32_t ack_id) const {
    for (const auto& x : packages()) {
      for (std::uint32_t i = 0; x.port() == 14 && i < x.word(40); ++i) {
        if (x.word(44 + 4 * i) == ack_id)
          return true;
      }
    }
    return false;
  }

private:
  bool open_ = false;
  bool closed_ = false;
  bytes in_;
  io::tcp_stream stream_;
  io::tcp_connect attempt_;
};

} // namespace rubicon::peer::test
