// A program in an actor of its own, at its node: remote_process's other side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "communication/interface.hpp"
#include "communication/layer.hpp"
#include "communication/remote_messages.hpp"
#include "core/describe/fields.hpp"

namespace rubicon::communication {

struct program_port_counters {
  std::uint64_t refused = 0; ///< commands that the layer refused; the program's side had not
  std::uint64_t dropped =
      0; ///< ticks, vectors and messages for a program that takes too few events
};
RUBICON_FIELDS(program_port_counters, refused, dropped);

/// Carries out the program's commands in its node's layer, and makes events for it of what the
/// layer reports. A program that does not take its events for long gets no reliable messages, as
/// their senders wait (MCK-18), and loses ticks, vectors and unreliable messages.
class program_port final : public communication_events {
public:
  /// Events that came before are sent: the node is up, or has joined.
  /// @param node a mote::node, pc or gateway::gateway
  /// @param events_max in flight when things are dropped; reliable messages wait from half of it on
  template <class Node>
  explicit program_port(Node& node, std::size_t events_max = 1024)
      : layer_(node.attach(*this)), limits_(limits_of(node.above())), events_max_(events_max) {
    catch_up(node.above());
  }

  ~program_port() override;                   // it is large: compiled once
  program_port(const program_port&) = delete; // its node points to it
  program_port& operator=(const program_port&) = delete;

  [[nodiscard]] const remote::limits& limits() const { return limits_; }

  /// Between the node's begin() and its settle() or flush().
  void on_commands(const remote::commands_batch& x);

  /// What is to be sent to the program, after each settle() or flush() of the node.
  [[nodiscard]] std::optional<remote::events_batch> take_events();

  /// The program has gone; nothing of this may be used afterwards. At the same
  /// time as on_commands().
  void leave();

  [[nodiscard]] const program_port_counters& counters() const { return counters_; }

  void createSynChannelOutDone(int channel, status success) override;
  void createSynChannelInDone(int channel, status success) override;
  void syn_input_update(int channel, std::uint8_t index, synaptic::input_status how) override;
  void clock_tick(std::uint32_t tick) override;
  [[nodiscard]] bool wants_ticks() const override { return wants_ticks_; }
  void synChannelFailed(int channel) override;
  void openRemoteDone(int stream, std::uint16_t name, status success) override;
  void readDone(int stream, byte_view record, status success) override;
  void ackOf(std::uint32_t number, status success) override;
  void receiveFrom(mote_address source, byte_view octets, std::uint8_t am_type) override;
  void transducersRead(std::span<const std::int16_t> counts, std::uint32_t time_ms) override;
  void actuatorChanged(std::string_view name, std::uint8_t state, bool obeyed) override;
  void initCommunicationsDone(status success) override;
  void joined(island_octet island, std::uint16_t mote, status success) override;
  void moteJoined(std::uint16_t mote, byte_view description) override;
  void outputsWanted(std::span<const output_wanted> all) override;

private:
  /// The program's numbers for what the layer numbers otherwise.
  struct numbering {
    std::map<std::uint16_t, int> here;
    std::map<int, std::uint16_t> there;

    void add(std::uint16_t program, int layer);
    void erase(std::uint16_t program);
    [[nodiscard]] std::optional<int> find(std::uint16_t program) const;
    [[nodiscard]] std::optional<std::uint16_t> program(int layer) const;
  };

  [[nodiscard]] static remote::limits limits_of(const layer& x);
  void catch_up(const layer& x);

  void carry_out(const remote::create_channel& x);
  void carry_out(const remote::start_channel& x);
  void carry_out(const remote::stop_channel& x);
  void carry_out(const remote::dispose_channel& x);
  void carry_out(const remote::set_outputs& x);
  void carry_out(const remote::open_end& x);
  void carry_out(const remote::open_sensor& x);
  void carry_out(const remote::open_local& x);
  void carry_out(const remote::close_stream& x);
  void carry_out(const remote::read_stream& x);
  void carry_out(const remote::write_stream& x);
  void carry_out(const remote::send_message& x);
  void carry_out(const remote::provide_type& x);
  void carry_out(const remote::hold_type& x);
  void carry_out(const remote::want_ticks& x);
  void carry_out(const remote::read_transducers& x);
  void carry_out(const remote::set_actuator& x);
  void carry_out(const remote::init& x);
  void carry_out(const remote::join& x);
  void carry_out(const remote::leave& x);

  void keep_open(std::uint16_t stream, int here);
  void on_created(int channel, bool is_out, status success);
  void send_event(remote::event x);
  void send_event_if_room(remote::event x);
  [[nodiscard]] std::size_t in_flight() const {
    return static_cast<std::size_t>(events_sent_ - events_acked_);
  }
  void throttle();

  interface layer_;
  remote::limits limits_;
  std::size_t events_max_ = 0;
  numbering streams_;
  numbering channels_;
  std::set<std::uint16_t> ends_;                 ///< remote streams whose end is to be reported
  std::map<std::uint16_t, std::uint8_t> sizes_;  ///< of synaptic channels
  std::map<std::uint32_t, std::uint32_t> sends_; ///< the layer's number, the program's
  std::set<std::uint8_t> types_;
  std::set<std::uint8_t> held_; ///< by the program
  bool wants_ticks_ = false;    ///< the program
  bool is_throttled_ = false;
  bool has_left_ = false;
  remote::events events_;            ///< to be sent
  std::uint64_t events_sent_ = 0;    ///< events so far
  std::uint64_t events_acked_ = 0;   ///< of them, acknowledged by the program
  std::uint64_t commands_ = 0;       ///< so far
  std::uint64_t commands_acked_ = 0; ///< of them, acknowledged to the program
  program_port_counters counters_;
};

} // namespace rubicon::communication
