// A program in Lua: its script uses the Mockup interface as programs in C++ do (docs/lua.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/application.hpp"
#include "apps/registry.hpp"
#include "communication/interface.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "script/resources.hpp"
#include "script/source.hpp"

struct lua_State;

namespace rubicon::script {

class state;

struct program_config {
  source script;
  limits most;
  settings values;
};

/// What files call `lua`: a kind for each table, which has the script.
/// @param streams that it has open at most, of each sort
[[nodiscard]] std::shared_ptr<const apps::application_kind>
make_kind(std::shared_ptr<const program_config> config, std::size_t streams);

/// Runs the main part of its script at its start. An event calls the global function of its name,
/// if there is one. Once the script has failed, the call that it has failed in throws
/// std::runtime_error with file, line and traceback, and the program does nothing any more.
class program final : public apps::application {
public:
  /// @param config not nullptr; programs that are alike share one
  program(std::shared_ptr<const program_config> config, random_stream rng);
  ~program() override;

  void on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override;
  [[nodiscard]] std::vector<apps::figure> figures() const override;

  /// If its script has a function for them, wherever that is set.
  [[nodiscard]] bool wants_ticks() const override { return wants_ticks_; }

  // What its script uses.
  using application::layer;
  using application::notify;
  using application::warn;
  [[nodiscard]] instant now(); ///< by the clock of the node, also while it starts
  [[nodiscard]] resources& own() { return own_; }

  void createSynChannelOutDone(int channel, communication::status success) override;
  void createSynChannelInDone(int channel, communication::status success) override;
  void syn_input_update(int channel, std::uint8_t index, synaptic::input_status status) override;
  void clock_tick(std::uint32_t currentClock) override;
  void synChannelFailed(int channel) override;
  void openRemoteDone(int stream_desc, std::uint16_t symbolic_name,
                      communication::status success) override;
  void readDone(int desc, byte_view buf, communication::status success) override;
  void ack(communication::status success) override;
  void ackOf(std::uint32_t number, communication::status success) override;
  void receive(communication::island_octet island, std::uint16_t mote, byte_view buf,
               std::uint8_t am_type, communication::status success) override;
  void receiveFrom(mote_address source, byte_view buf, std::uint8_t am_type) override;
  void outputsWanted(std::span<const communication::output_wanted> all) override;
  void transducersRead(std::span<const std::int16_t> counts, std::uint32_t time_ms) override;
  void actuatorChanged(std::string_view name, std::uint8_t state, bool obeyed) override;
  void initCommunicationsDone(communication::status success) override;
  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void moteJoined(std::uint16_t mote, byte_view description) override;

private:
  void on_start(instant now) override;
  template <class... Args>
  void call(const char* event, const Args&... arguments);
  void do_event(const std::function<void(lua_State*)>& what);
  void throw_failure() const;

  std::shared_ptr<const program_config> config_;
  bool wants_ticks_;
  std::unique_ptr<state> lua_;
  std::optional<instant> starts_at_; ///< while its main part runs
  resources own_;
  std::uint64_t events_ = 0;
};

} // namespace rubicon::script
