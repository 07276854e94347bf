#include "actors/hosts/firmware_code.hpp"

#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "firmware/native_code.hpp"
#include "firmware/remote_code.hpp"
#include "io/process/isolated_process.hpp"
#include "io/process/shared_library.hpp"

namespace rubicon {

namespace {

const rubicon_mote_firmware& exported_by(const io::shared_library& x) {
  const auto* found = static_cast<const rubicon_mote_firmware*>(x.symbol(firmware::exported_name));
  if (found == nullptr)
    throw std::runtime_error(std::string("the firmware exports no ") + firmware::exported_name);
  return *found;
}

/// In this process.
class loaded_code final : public firmware::code {
public:
  explicit loaded_code(byte_view library)
      : library_("rubicon-firmware", library), code_(exported_by(library_)) {}

  void init(const firmware::identity& who, firmware::host& of) override { code_.init(who, of); }
  void run(std::uint64_t now_us) override { code_.run(now_us); }
  void received(std::uint64_t now_us, byte_view frame, int rssi_dbm) override {
    code_.received(now_us, frame, rssi_dbm);
  }
  void sent(std::uint64_t now_us, firmware::outcome how) override { code_.sent(now_us, how); }

private:
  io::shared_library library_; ///< outlives what it is the code of
  firmware::native_code code_;
};

/// The end of the firmware, in the process of its own.
class inner_pipe final : public firmware::message_pipe {
public:
  inner_pipe(io::isolated_end& end, const std::function<void()>& renew)
      : end_(end), renew_(renew) {}

  void begin_call() override { renew_(); }
  void send(byte_view message) override {
    if (!end_.send(message))
      throw std::runtime_error("the run has ended");
  }
  bytes receive() override {
    bytes message;
    if (!end_.receive(message))
      throw std::runtime_error("the run has ended");
    return message;
  }

private:
  io::isolated_end& end_;
  const std::function<void()>& renew_;
};

/// The end of the host.
class outer_pipe final : public firmware::message_pipe {
public:
  explicit outer_pipe(byte_view library)
      : process_({.message_octets_max = firmware::message_octets_max},
                 [library](io::isolated_end& end, const std::function<void()>& renew) {
                   inner_pipe pipe(end, renew);
                   firmware::serve(pipe,
                                   [library] { return std::make_unique<loaded_code>(library); });
                 }) {}

  void begin_call() override { process_.begin_call(); }
  void send(byte_view message) override {
    explain([&] { process_.send(message); });
  }
  bytes receive() override {
    return explain([&] { return process_.receive(); });
  }

private:
  template <class Step>
  static std::invoke_result_t<Step> explain(Step step) {
    try {
      return step();
    } catch (const std::runtime_error& x) {
      throw std::runtime_error(std::string("the firmware failed: ") + x.what());
    }
  }

  io::isolated_process process_;
};

/// In a process of its own.
class isolated_code final : public firmware::code {
public:
  explicit isolated_code(byte_view library) : pipe_(library), code_(pipe_) {}

  void init(const firmware::identity& who, firmware::host& of) override { code_.init(who, of); }
  void run(std::uint64_t now_us) override { code_.run(now_us); }
  void received(std::uint64_t now_us, byte_view frame, int rssi_dbm) override {
    code_.received(now_us, frame, rssi_dbm);
  }
  void sent(std::uint64_t now_us, firmware::outcome how) override { code_.sent(now_us, how); }

private:
  outer_pipe pipe_;
  firmware::remote_code code_;
};

} // namespace

std::unique_ptr<firmware::code> load_firmware(const firmware::program_config& x) {
  if (x.isolate)
    return std::make_unique<isolated_code>(x.code->octets);
  return std::make_unique<loaded_code>(x.code->octets);
}

} // namespace rubicon
