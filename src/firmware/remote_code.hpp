// A firmware in another process: both ends of what the processes exchange (docs/firmware.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include "core/bytes.hpp"
#include "firmware/code.hpp"

namespace rubicon::firmware {

inline constexpr std::size_t message_octets_max = 2048;

/// One end of a connection that keeps messages apart.
class message_pipe {
public:
  message_pipe() = default;
  message_pipe(const message_pipe&) = delete;
  message_pipe& operator=(const message_pipe&) = delete;
  virtual ~message_pipe() = default;

  /// A call of a function of the firmware begins: what limits its time begins anew.
  virtual void begin_call() = 0;
  /// @throws std::runtime_error if the other end is gone, with the reason
  virtual void send(byte_view message) = 0;
  virtual bytes receive() = 0; ///< waits; throws likewise
};

/// The end of the host. What comes from the other end is checked: it may be anything.
class remote_code final : public code {
public:
  /// @param pipe outlives this
  explicit remote_code(message_pipe& pipe) : pipe_(pipe) {}

  void init(const identity& who, host& of) override;
  void run(std::uint64_t now_us) override;
  void received(std::uint64_t now_us, byte_view frame, int rssi_dbm) override;
  void sent(std::uint64_t now_us, outcome how) override;

private:
  void call(const bytes& message);
  /// @returns whether the call goes on
  [[nodiscard]] bool follow(byte_view message);
  void answer_with(std::uint32_t value, bool is_there);

  message_pipe& pipe_;
  host* host_ = nullptr;
};

/// The end of the firmware: calls its functions as the host requests, until the pipe throws.
/// @param load at the first call; what it throws is reported to the host
void serve(message_pipe& pipe, const std::function<std::unique_ptr<code>()>& load);

} // namespace rubicon::firmware
