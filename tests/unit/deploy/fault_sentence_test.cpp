#include "deploy/fault_sentence.hpp"

#include <string>

#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::deploy;

namespace {

const bundle house{"house.toml",
                   R"([ecology]
name = "house"
[[island]]
id = 1
name = "kitchen"
[[island.mote]]
id = 3
name = "stove"
type = 7
position_m = [1, 1]
[[peer]]
id = 40
name = "robot"
[[fault]]
at = "0s"
kind = "kill"
peer = "robot"
[[fault]]
every = "1min"
kind = "pause"
peer = "robot")", {}, {}, {}, {}, 1, 10min};

template <class Fault>
Fault fault_in(const std::string& sentence) {
  const auto found = fault_of(house, sentence, {});
  INFO(sentence);
  if (const auto* why = std::get_if<std::string>(&found))
    FAIL(*why);
  const auto* fault = std::get_if<Fault>(&std::get<config::fault>(found));
  REQUIRE(fault != nullptr);
  return *fault;
}

std::string refusal(const std::string& sentence) {
  const auto found = fault_of(house, sentence, {});
  const auto* why = std::get_if<std::string>(&found);
  return why == nullptr ? "" : *why;
}

} // namespace

TEST_CASE("a fault in words is what a file would say", "[deploy]") {
  const auto kill = fault_in<config::kill_fault>("kill peer robot for 10s");
  CHECK(kill.peer == peer_id(40));
  CHECK(kill.length == duration(10s));
  CHECK_FALSE(fault_in<config::kill_fault>("kill peer *").length);
  CHECK(fault_in<config::crash_fault>("crash mote kitchen/stove").length == 500ms);
  CHECK(fault_in<config::crash_fault>("  kill  mote kitchen/stove for 2s ").length == 2s);
  CHECK(fault_in<config::sink_crash_fault>("kill sink kitchen").island == island_id(1));
  CHECK(fault_in<config::link_loss_fault>("link_loss loss 0.25 for 1min").loss == 0.25);
  CHECK(fault_in<config::clock_step_fault>("clock_step peer robot by -2s").by == -2s);
}

TEST_CASE("what is no fault is refused with the words of a file", "[deploy]") {
  CHECK(refusal("").find("which fault?") != std::string::npos);
  CHECK_FALSE(refusal("kill").empty());
  CHECK(refusal("kill peer").find("keys and values") != std::string::npos);
  CHECK(refusal("kill peer nobody").find("nobody") != std::string::npos);
  CHECK(refusal("network_keys network_key 000102030405060708090a0b0c0d0e0f") ==
        "no mote has the program `member`: there are no network keys");
  CHECK(refusal("explode peer robot").find("explode") != std::string::npos);
  CHECK_FALSE(refusal("kill peer robot for ever").empty());
  CHECK_FALSE(refusal("kill peer robot colour red").empty());
  CHECK(refusal("kill PEER robot").find("`PEER` is not a key") != std::string::npos);
  CHECK(refusal("noise island kitchen position_m [1,1]").find("plan it in the file") !=
        std::string::npos);
  CHECK_FALSE(refusal(std::string(sentence_octets_max + 1, 'x')).empty());
}

TEST_CASE("a fault in words cannot say anything else of a file", "[deploy]") {
  for (const auto* hostile :
       {"kill peer \"robot\"\n[[peer]]\nid=9", "kill peer robot\"", "kill peer {a=1}",
        "kill peer robot\\", "kill peer [\"robot\"", "kill peer [[fault]]", "[[peer]] id 9"})
    CHECK_FALSE(refusal(hostile).empty());
}

TEST_CASE("a change in words is what a file would say", "[deploy][ACT-10]") {
  const auto with = [](const std::string& sentence) {
    auto file = house;
    file.toml += R"(
[[change]]
at = "0s"
kind = "debug"
of = ["gateway"]
)";
    return fault_of(file, sentence, {});
  };
  const auto debug = with("debug of mote/kitchen,sink");
  REQUIRE(debug.index() == 0);
  const auto& change = std::get<config::change>(std::get<config::fault>(debug));
  CHECK(std::get<config::debug_change>(change).of ==
        std::vector<std::string>{"mote/kitchen", "sink"});
  const auto kill = with("kill peer robot"); // the file's change is none of the faults
  REQUIRE(kill.index() == 0);
  CHECK(std::holds_alternative<config::kill_fault>(std::get<config::fault>(kill)));
  CHECK(refusal("rate mote kitchen/stove period 5s") ==
        "that mote has no sampler and no messenger; other programs keep their periods, which both "
        "ends of a stream or flow have agreed on");
  CHECK(refusal("seed value 7").starts_with("`seed` cannot change while an ecology runs"));
  CHECK(refusal("explode peer robot").find("or of a change \"debug\"") != std::string::npos);
  CHECK(refusal("crsh mote kitchen/stove for 10s").ends_with("; did you mean \"crash\"?"));
  CHECK(table_of("link from kitchen/stove to kitchen/sink loss 20%", "3s") ==
        "\n[[change]]\nat = \"3s\"\nkind = \"link\"\nfrom = \"kitchen/stove\"\n"
        "to = \"kitchen/sink\"\nloss = \"20%\"\n");
  CHECK(is_change_sentence(" debug of *"));
  CHECK_FALSE(is_change_sentence("kill peer robot"));
  CHECK_FALSE(is_change_sentence(""));
}
