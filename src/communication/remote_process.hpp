// A program in an actor of its own, on its side: commands become messages to its node's actor, the
// answers become events.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "communication/interface.hpp"
#include "communication/process.hpp"
#include "communication/remote_messages.hpp"
#include "core/describe/fields.hpp"

namespace rubicon::communication {

struct remote_counters {
  std::uint64_t refused = 0;     ///< commands that returned FAIL
  std::uint64_t before_join = 0; ///< of them, for want of a join (MCK-16)
  std::uint64_t no_room = 0;     ///< of them, because too many were in flight
  std::uint64_t bad_reads = 0;   ///< read_input() without a value (A-07)
};
RUBICON_FIELDS(remote_counters, refused, before_join, no_room, bad_reads);

/// Answers commands at once by what it knows of the program's streams and channels, and of the
/// node's tables. program_port at the node carries them out, and refuses what only the node knows.
///
/// Whoever owns one calls begin() before commands that are not given from within an event, and
/// sends what flush() returns after each of its functions.
class remote_process final : public process {
public:
  /// @param commands_max that the node has not taken; closing and disposing do not count
  explicit remote_process(remote::limits node, std::size_t commands_max = 256)
      : node_(node), commands_max_(commands_max) {}
  ~remote_process() override; // it is large: compiled once

  /// The program; it outlives this.
  [[nodiscard]] interface attach(communication_events& program);

  void begin(instant now) { now_ = now; }
  void on_events(const remote::events_batch& x, instant now);
  [[nodiscard]] std::optional<remote::commands_batch> flush();

  [[nodiscard]] std::size_t commands_in_flight() const; ///< not taken by the node
  [[nodiscard]] const remote_counters& counters() const { return counters_; }

  status refuse() override;

  int create_syn_channel(bool is_out, mote_address other, std::uint8_t size,
                         const synaptic::parameters& params) override;
  status dispose_syn_channel(int channel) override;
  status start_syn_channel(int channel) override;
  status stop_syn_channel(int channel) override;
  status write_output(int channel, std::uint8_t k, float value) override;
  float read_input(int channel, std::uint8_t index) override;

  int open_end(const stream_end& end) override;
  int open_sensor(std::uint8_t transducer, std::uint32_t period_ms, stream::sampling kind) override;
  int open_local() override;
  status close(int desc) override;
  status read(int desc, std::size_t nbytes) override;
  status write(int desc, byte_view record) override;
  [[nodiscard]] bool has_ended(int desc) const override;
  [[nodiscard]] std::optional<duration> latency_bound(int desc) const override;

  std::optional<std::uint32_t> send(mote_address to, byte_view octets, bool reliable,
                                    std::uint8_t am_type) override;
  status provide(std::uint8_t am_type) override;
  void hold(std::uint8_t am_type) override;
  void release(std::uint8_t am_type) override;

  status read_transducers(std::span<const device::quantity> kinds) override;
  status set_actuator(std::string_view name, std::uint8_t state) override;

  status init() override;
  status join(byte_view description) override;
  [[nodiscard]] std::optional<mote_address> address() const override { return self_; }
  [[nodiscard]] instant now() const override { return now_; }
  [[nodiscard]] std::optional<duration> network_time() const override { return std::nullopt; }

  void leave() override;

private:
  static constexpr std::uint16_t descriptor_max = 32767;

  using pending_event = std::function<void(communication_events&)>;

  enum class phase : std::uint8_t { opening, open, ended };
  enum class kind : std::uint8_t { sensor, local, writer, reader };

  struct stream_row {
    kind what = kind::local;
    bool is_opening = false;
    bool has_ended = false;
    bool is_reading = false;
    std::size_t record_max = 0;
    std::uint16_t name = 0;          ///< of a remote one
    remote::open_sensor sensor = {}; ///< of a sensor stream
    std::optional<duration> latency_bound = {};
  };

  struct channel_row {
    bool is_out = false;
    phase at = phase::opening;
    mote_address other;
    std::vector<float> values; ///< ChOut or ChIn
    bool is_active = false;
  };

  struct pending_send {
    std::uint32_t number = 0;
    std::optional<bool> acked; ///< nothing: it has not ended
  };

  [[nodiscard]] bool may_talk();
  [[nodiscard]] bool has_room(); ///< for one more command
  template <class Rows>
  [[nodiscard]] static auto find(Rows& rows, int number) -> decltype(&rows.begin()->second) {
    const bool is_one = number > 0 && number <= descriptor_max;
    const auto found = rows.find(is_one ? static_cast<std::uint16_t>(number) : std::uint16_t{});
    return found == rows.end() ? nullptr : &found->second;
  }
  template <class Row>
  [[nodiscard]] static std::uint16_t add(std::map<std::uint16_t, Row>& rows, std::uint16_t& last,
                                         Row row) {
    do
      last = static_cast<std::uint16_t>(last % descriptor_max + 1);
    while (rows.contains(last));
    rows.emplace(last, std::move(row));
    return last;
  }
  [[nodiscard]] bool has_stream(kind what, std::uint16_t name) const;
  [[nodiscard]] channel_row* open_channel(int channel, bool is_out); ///< nullptr: refused
  [[nodiscard]] mote_address resolved(mote_address x, island_id own) const;

  void apply(const remote::channel_created& x);
  void apply(const remote::inputs_shown& x);
  void apply(const remote::channel_failed& x);
  void apply(const remote::ticked& x);
  void apply(const remote::stream_opened& x);
  void apply(const remote::record_read& x);
  void apply(const remote::stream_ended& x);
  void apply(const remote::send_ended& x);
  void apply(const remote::message_received& x);
  void apply(const remote::type_refused& x);
  void apply(const remote::transducers_read& x);
  void apply(const remote::actuator_changed& x);
  void apply(const remote::initialised& x);
  void apply(const remote::joined& x);
  void apply(const remote::mote_joined& x);
  void apply(const remote::outputs_asked& x);
  void report_created(std::uint16_t channel, bool is_out, bool success);
  void dispatch();
  void order_holds();

  remote::limits node_;
  std::size_t commands_max_ = 0;
  communication_events* program_ = nullptr;
  instant now_;
  bool initialised_ = false;
  std::optional<mote_address> self_;

  std::map<std::uint16_t, stream_row> streams_;
  std::map<std::uint16_t, channel_row> channels_;
  std::uint16_t last_stream_ = 0;
  std::uint16_t last_channel_ = 0;
  std::deque<pending_send> sends_; ///< ack() keeps their order (A-56)
  std::uint32_t last_number_ = 0;
  std::set<std::uint8_t> types_;
  std::set<std::uint8_t> held_;         ///< of these, by the program
  std::set<std::uint8_t> held_at_node_; ///< as sent to the node

  std::deque<pending_event> pending_events_;
  bool dispatching_ = false;
  remote::commands commands_;      ///< to be sent
  std::uint64_t sent_ = 0;         ///< commands so far
  std::uint64_t sent_taken_ = 0;   ///< of them, by the node
  std::uint64_t events_ = 0;       ///< so far
  std::uint64_t events_acked_ = 0; ///< of them, acknowledged to the node
  remote_counters counters_;
};

} // namespace rubicon::communication
