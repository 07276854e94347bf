// What a layer above needs to be tested on a PC, before there is any mote, radio, kernel or actor:
// the Mockup interface, and a loop that carries what its nodes send (MCK-17). This file includes
// and links nothing else of the product.
#include <map>
#include <optional>
#include <vector>

#include "communication/pc.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

/// The layer under test: sends its tick number on a synaptic channel.
class counting_neuron : public communication::communication_events {
public:
  explicit counting_neuron(mote_address to) : to_(to) {}

  void joined(communication::island_octet, std::uint16_t, communication::status) override {
    channel_ = layer->create_syn_channel_out(to_, 1, {});
  }
  void createSynChannelOutDone(int channel, communication::status success) override {
    if (success == communication::SUCCESS)
      static_cast<void>(layer->start_syn_channel(channel));
  }
  void clock_tick(std::uint32_t tick) override {
    written = static_cast<float>(tick);
    static_cast<void>(layer->write_output(channel_, 0, written));
  }

  std::optional<communication::interface> layer;
  float written = 0;

private:
  mote_address to_;
  int channel_ = 0;
};

/// Notes what its input shows at each tick, and answers control messages of AM type 42.
class noting_neuron : public communication::communication_events {
public:
  explicit noting_neuron(mote_address from) : from_(from) {}

  void joined(communication::island_octet, std::uint16_t, communication::status) override {
    static_cast<void>(layer->provide(42));
    static_cast<void>(layer->create_syn_channel_in(from_, 1, {}));
  }
  void createSynChannelInDone(int channel, communication::status success) override {
    if (success == communication::SUCCESS)
      static_cast<void>(layer->start_syn_channel(channel));
  }
  void syn_input_update(int channel, std::uint8_t index, synaptic::input_status status) override {
    if (status == synaptic::input_status::updated)
      inputs.push_back(layer->read_input(channel, index));
  }
  void receive(communication::island_octet, std::uint16_t, byte_view buf, std::uint8_t,
               communication::status) override {
    orders.push_back(to_bytes(buf));
  }

  std::optional<communication::interface> layer;
  std::vector<float> inputs;
  std::vector<bytes> orders;

private:
  mote_address from_;
};

/// Two PCs; what one sends is there at once.
struct lab {
  lab() {
    writer.layer = pcs.at(peer_id{1}).attach(writer);
    reader.layer = pcs.at(peer_id{2}).attach(reader);
    for (auto& [id, pc] : pcs)
      carry(id, pc.start(now));
  }

  void carry(peer_id from, communication::outputs todo) {
    for (auto& x : todo) {
      const auto message = communication::message_of(std::move(x));
      carry(message.peer, pcs.at(message.peer).on_message(from, message.octets, now));
    }
  }

  void run_until(instant end) {
    for (;;) {
      auto* due = &*pcs.begin();
      for (auto& x : pcs) {
        if (x.second.deadline() < due->second.deadline())
          due = &x;
      }
      if (*due->second.deadline() > end)
        return;
      now = *due->second.deadline();
      carry(due->first, due->second.on_time(now));
    }
  }

  static constexpr mote_address first{island_id{1}, no_mote};
  static constexpr mote_address second{island_id{2}, no_mote};
  counting_neuron writer{second};
  noting_neuron reader{first};
  std::map<peer_id, communication::pc> pcs = [] {
    std::map<peer_id, communication::pc> x;
    for (const auto id : {1, 2})
      x.try_emplace(peer_id{id}, communication::pc_config{.self = peer_id{id}},
                    random_stream(static_cast<std::uint64_t>(id)));
    return x;
  }();
  instant now;
};

} // namespace

TEST_CASE("a learning layer runs over the Mockup interface alone, on one PC",
          "[communication][MCK-17][IF-02][GEN-08]") {
  lab x;
  x.run_until(x.now + 20s);
  REQUIRE(x.reader.inputs.size() > 30); // 40 ticks, less those that the channel took to open
  for (std::size_t i = 1; i < x.reader.inputs.size(); ++i)
    CHECK(x.reader.inputs[i] == x.reader.inputs[i - 1] + 1);
  CHECK(x.writer.written - x.reader.inputs.back() <= 1);

  auto& writer = x.pcs.at(peer_id{1});
  writer.begin(x.now);
  CHECK(x.writer.layer->send(2, no_mote.value, bytes{7}, true, 42) == communication::SUCCESS);
  x.carry(peer_id{1}, writer.flush());
  CHECK(x.reader.orders == std::vector<bytes>{{7}});
}
