// A peer that joins a network for the length of one command.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "cli/words/network_command.hpp"
#include "io/loop.hpp"
#include "peer/standalone.hpp"

namespace rubicon::cli {

/// How what is said of a peer begins that closes our link at once.
inline constexpr std::string_view other_network = " answers, but is not a peer of the network `";

/// It accepts no links and forwards nothing. It leaves when it is destroyed.
class temporary_peer {
public:
  /// Connects and waits until the other peer has introduced itself.
  /// @returns why that failed
  [[nodiscard]] static std::variant<std::unique_ptr<temporary_peer>, std::string>
  join(io::loop& where, const network_options& options);

  ~temporary_peer();
  temporary_peer(const temporary_peer&) = delete;
  temporary_peer& operator=(const temporary_peer&) = delete;

  [[nodiscard]] peer::standalone& peer() { return *peer_; }

  /// Waits until a peer can be reached. @returns false if it cannot within the timeout
  [[nodiscard]] bool await_host(peer_id host);

  /// Waits until `found`, and then until nothing new has come for a while.
  /// @param news grows with everything that comes
  [[nodiscard]] bool await_quiet(const std::function<bool()>& found,
                                 const std::function<std::size_t()>& news);

private:
  temporary_peer() = default;

  network_options options_;
  std::string last_failure_;
  std::unique_ptr<peer::standalone> peer_;
};

} // namespace rubicon::cli
