#include "firmware/remote_code.hpp"

#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::firmware;

namespace {

/// What a firmware's process sends is given in advance; what it is sent is kept.
struct scripted_pipe final : message_pipe {
  std::deque<bytes> from_firmware;
  std::vector<bytes> to_firmware;

  void begin_call() override {}
  void send(byte_view message) override { to_firmware.push_back(to_bytes(message)); }
  bytes receive() override {
    if (from_firmware.empty())
      throw std::runtime_error("nothing more");
    auto message = std::move(from_firmware.front());
    from_firmware.pop_front();
    return message;
  }
};

struct noting_host final : host {
  std::vector<std::string> requests;

  answer send(byte_view frame) override {
    requests.push_back("send " + to_hex(frame));
    return RUBICON_MOTE_FULL;
  }
  void set_radio(bool on) override { requests.emplace_back(on ? "on" : "off"); }
  void set_timer(std::uint64_t at_us) override {
    requests.push_back("timer " + std::to_string(at_us));
  }
  void write_serial(byte_view octets) override { requests.push_back("serial " + to_hex(octets)); }
  std::uint32_t draw() override { return 0x01020304; }
  std::optional<std::int32_t> read(std::string_view sensor) override {
    return sensor == "light" ? std::optional(-2) : std::nullopt;
  }
  void set_leds(unsigned on) override { requests.push_back("leds " + std::to_string(on)); }
  void log(std::string_view line) override { requests.emplace_back(line); }
};

/// Requests all that there is, and keeps the answers.
struct asking_code final : code {
  std::vector<std::string>& answers;
  host* of = nullptr;

  explicit asking_code(std::vector<std::string>& x) : answers(x) {}
  void init(const identity& who, host& its) override {
    of = &its;
    answers.push_back(std::to_string(who.mote) + ' ' + std::to_string(who.channel));
  }
  void run(std::uint64_t now_us) override {
    of->set_radio(true);
    answers.push_back(std::to_string(of->send(bytes{1, 2, 3})));
    answers.push_back(std::to_string(of->draw()));
    answers.push_back(std::to_string(of->read("light").value_or(0)));
    answers.push_back(of->read("sound") ? "some" : "none");
    of->set_timer(now_us + 5);
    of->set_leds(6);
    of->write_serial(bytes{7});
    of->log("line");
  }
  void received(std::uint64_t, byte_view, int rssi_dbm) override {
    answers.push_back(std::to_string(rssi_dbm));
    throw std::runtime_error("wrong");
  }
  void sent(std::uint64_t, outcome how) override { answers.push_back(std::to_string(how)); }
};

const bytes done{9};

} // namespace

TEST_CASE("both ends of a firmware in another process understand each other", "[firmware]") {
  scripted_pipe pipe;
  noting_host its;
  remote_code far(pipe);
  // What the host sends is the input of the firmware's end, whose requests are the host's.
  pipe.from_firmware = {done, done, done, done};
  far.init({7, 20, 15}, its);
  far.run(100);
  far.sent(200, RUBICON_MOTE_BUSY);
  far.received(300, bytes{1, 2}, -71);
  const auto calls = pipe.to_firmware;
  REQUIRE(calls.size() == 4);

  const bytes full{5, 1, 1, 0, 0, 0};
  const bytes drawn{5, 1, 4, 3, 2, 1};
  const bytes minus_two{5, 1, 0xfe, 0xff, 0xff, 0xff};
  const bytes absent{5, 0, 0, 0, 0, 0};
  scripted_pipe other;
  other.from_firmware = {calls[0], calls[1], full, drawn, minus_two, absent, calls[2], calls[3]};
  std::vector<std::string> answers;
  CHECK_THROWS_WITH(serve(other, [&] { return std::make_unique<asking_code>(answers); }),
                    "nothing more");
  CHECK(answers == std::vector<std::string>{"7 15", "1", "16909060", "-2", "none", "2", "-71"});

  // And back: the requests of the call `run`, up to its end.
  scripted_pipe back;
  for (std::size_t i = 1; i < 11; ++i)
    back.from_firmware.push_back(other.to_firmware.at(i));
  remote_code near(back);
  back.from_firmware.push_front(done);
  near.init({7, 20, 15}, its);
  back.to_firmware.clear();
  near.run(100);
  CHECK(its.requests ==
        std::vector<std::string>{"on", "send 010203", "timer 105", "leds 6", "serial 07", "line"});
  REQUIRE(back.to_firmware.size() == 5);
  CHECK(back.to_firmware[1] == full);
  CHECK(back.to_firmware[2] == drawn);
  CHECK(back.to_firmware[3] == minus_two);
  CHECK(back.to_firmware[4] == absent);
  // The call that failed says why.
  back.from_firmware = {other.to_firmware.back()};
  CHECK_THROWS_WITH(near.run(100), "wrong");
}

TEST_CASE("what a firmware's process sends is checked", "[firmware]") {
  for (const auto& each :
       {bytes{}, bytes{0}, bytes{11}, bytes{255, 1}, bytes{2}, bytes{3, 1}, bytes{7, 1, 2}}) {
    scripted_pipe pipe;
    noting_host its;
    pipe.from_firmware = {done, each, done};
    remote_code far(pipe);
    far.init({}, its);
    CHECK_THROWS_WITH(far.run(1), "the firmware's process sends what is no request");
  }
}
