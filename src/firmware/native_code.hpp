// A firmware in the memory of this process.
#pragma once

#include "firmware/code.hpp"

namespace rubicon::firmware {

class native_code final : public code {
public:
  /// @param exported by a library that stays loaded as long as this
  /// @throws std::runtime_error for another version, or one without functions that it must have
  explicit native_code(const rubicon_mote_firmware& exported);
  ~native_code() override;

  void init(const identity& who, host& of) override;
  void run(std::uint64_t now_us) override;
  void received(std::uint64_t now_us, byte_view frame, int rssi_dbm) override;
  void sent(std::uint64_t now_us, outcome how) override;

private:
  const rubicon_mote_firmware& exported_;
  rubicon_mote_host host_{};
  void* mote_ = nullptr; ///< nullptr: not initialised
};

} // namespace rubicon::firmware
