// Serial ports and pseudo-terminals, which are each other's ends here.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <variant>

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include "core/time.hpp"
#include "io/process/process.hpp"
#include "io/serial/port_holders.hpp"
#include "io/serial/pseudo_terminal.hpp"
#include "io/serial/serial_port.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "unit/io/run.hpp"

using namespace rubicon;
using test::run;

namespace {

constexpr std::size_t room = 4096;

/// A terminal and everything that happened to it.
struct offered {
  io::pseudo_terminal terminal;
  bytes received;
  std::size_t comings = 0;
  bool attached = false;

  offered(io::loop& loop, const std::string& link) {
    auto x = io::pseudo_terminal::open(loop, link, room);
    if (const auto* why = std::get_if<std::string>(&x))
      FAIL(*why);
    terminal = std::get<io::pseudo_terminal>(std::move(x));
    terminal.start({[this](byte_view octets) {
                      received.insert(received.end(), octets.begin(), octets.end());
                    },
                    [this](bool there) {
                      attached = there;
                      comings += there ? 1 : 0;
                    }});
  }
};

struct opened {
  io::serial_port port;
  bytes received;
  std::optional<std::string> closed;

  opened(io::loop& loop, const std::string& path) {
    auto x = io::serial_port::open(loop, path, 57600, room);
    if (const auto* why = std::get_if<std::string>(&x))
      FAIL(*why);
    port = std::get<io::serial_port>(std::move(x));
    port.start({[this](byte_view octets) {
                  received.insert(received.end(), octets.begin(), octets.end());
                },
                [this](const std::string& why) { closed = why; }});
  }
};

/// Every value, among them those that terminals take for commands.
bytes all_octets() {
  bytes x(256);
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = static_cast<std::uint8_t>(i);
  return x;
}

std::string why_not(io::loop& loop, const std::string& path, std::uint32_t baud = 57600) {
  const auto x = io::serial_port::open(loop, path, baud, room);
  return std::holds_alternative<std::string>(x) ? std::get<std::string>(x) : "it opens";
}

} // namespace

TEST_CASE("all octets pass a pseudo-terminal as they are, both ways", "[io][GW-17]") {
  const test::scratch_folder folder;
  io::loop loop;
  offered mote(loop, folder.file("run/sink"));
  opened pc(loop, folder.file("run/sink"));
  run(loop, [&] { return mote.attached; });
  CHECK(mote.terminal.send(all_octets()));
  CHECK(pc.port.send(all_octets()));
  run(loop, [&] { return pc.received.size() >= 256 && mote.received.size() >= 256; });
  CHECK(pc.received == all_octets());
  CHECK(mote.received == all_octets());
}

TEST_CASE("programs come to a pseudo-terminal and go, and nobody gets what was another's",
          "[io][GW-17]") {
  const test::scratch_folder folder;
  io::loop loop;
  offered mote(loop, folder.file("sink"));
  CHECK(!mote.terminal.send(bytes{1})); // nobody is there
  for (std::uint8_t i = 1; i <= 3; ++i) {
    {
      opened pc(loop, folder.file("sink"));
      run(loop, [&] { return mote.attached; });
      CHECK(mote.terminal.send(bytes{i}));
      run(loop, [&] { return !pc.received.empty(); });
      CHECK(pc.received == bytes{i});
      pc.port.read(false);
      CHECK(mote.terminal.send(bytes{99})); // is never read
    }
    run(loop, [&] { return !mote.attached; });
    CHECK(!mote.terminal.send(bytes{1}));
  }
  CHECK(mote.comings == 3);
}

TEST_CASE("a program that does not read is in nobody's way", "[io][GW-17]") {
  const test::scratch_folder folder;
  io::loop loop;
  offered mote(loop, folder.file("sink"));
  opened pc(loop, folder.file("sink"));
  pc.port.read(false);
  run(loop, [&] { return mote.attached; });
  std::size_t taken = 0;
  bool full = false;
  for (int i = 0; i < 1000 && !full; ++i) {
    full = !mote.terminal.send(bytes(100, 0x55));
    taken += full ? 0 : 100;
    loop.poll();
  }
  CHECK(full);
  CHECK(taken >= room - 100);
  pc.port.read(true);
  run(loop, [&] { return pc.received.size() == taken; });
  CHECK(mote.terminal.send(bytes(100, 0x55)));
}

TEST_CASE("a serial port tells that its other end has gone, and opens again with a new one",
          "[io][GW-15]") {
  const test::scratch_folder folder;
  io::loop loop;
  std::optional<offered> mote;
  mote.emplace(loop, folder.file("sink"));
  {
    opened pc(loop, folder.file("sink"));
    run(loop, [&] { return mote->attached; });
    mote.reset();
    run(loop, [&] { return pc.closed.has_value(); });
    CHECK(!pc.port.send(bytes{1}));
  }
  CHECK(!std::filesystem::is_symlink(folder.file("sink")));
  mote.emplace(loop, folder.file("sink"));
  opened pc(loop, folder.file("sink"));
  run(loop, [&] { return mote->attached; });
  CHECK(mote->terminal.send(bytes{7}));
  run(loop, [&] { return !pc.received.empty(); });
}

TEST_CASE("a port that cannot be had is told with what to do", "[io][GW-17]") {
  const test::scratch_folder folder;
  io::loop loop;
  CHECK(why_not(loop, folder.file("ttyUSB0")).find("is the mote plugged in?") != std::string::npos);
  std::ofstream(folder.file("file")) << "text";
  CHECK(why_not(loop, folder.file("file")).find("it is not a serial port") != std::string::npos);
  const offered mote(loop, folder.file("sink"));
  CHECK(why_not(loop, folder.file("sink"), 12345).find("12345 baud cannot be set") !=
        std::string::npos);
}

TEST_CASE("a link is made where nothing is, or one of a program that has ended", "[io][GW-17]") {
  const test::scratch_folder folder;
  io::loop loop;
  const auto link = folder.file("sink");
  std::filesystem::create_symlink("/dev/pts/999999", link);
  const offered mote(loop, link);
  CHECK(std::filesystem::read_symlink(link) != "/dev/pts/999999");

  const auto again = io::pseudo_terminal::open(loop, link, room);
  REQUIRE(std::holds_alternative<std::string>(again));
  CHECK(std::get<std::string>(again).find("another program provides it") != std::string::npos);

  std::ofstream(folder.file("file")) << "text";
  const auto file = io::pseudo_terminal::open(loop, folder.file("file"), room);
  REQUIRE(std::holds_alternative<std::string>(file));
  CHECK(std::get<std::string>(file).find("not a link to a pseudo-terminal") != std::string::npos);
  CHECK(std::filesystem::file_size(folder.file("file")) == 4);
}

TEST_CASE("a port that another program has without a lock is refused with that program's name",
          "[io][serial][GW-17]") {
  const test::scratch_folder folder;
  io::loop loop;
  const auto path = folder.file("port");
  const offered other_end(loop, path);
  CHECK(io::holder_of_terminal(path).empty());
  std::optional<io::process_end> end;
  auto found = io::process::start(
      loop, {.program = "/bin/sh", .words = {"sh", "-c", "exec 3<>" + path + "; exec sleep 100"}},
      {[](io::process::output, byte_view) {}, [&end](io::process_end how) { end = how; }});
  REQUIRE(std::holds_alternative<io::process>(found));
  auto& holder = std::get<io::process>(found);
  const auto soon = [&](const std::function<bool()>& done) {
    const auto limit = std::chrono::steady_clock::now() + 20s;
    while (!done() && std::chrono::steady_clock::now() < limit)
      loop.wait_until(std::chrono::steady_clock::now() + 10ms);
    REQUIRE(done());
  };
  soon([&] { return io::holder_of_terminal(path).starts_with("sleep (process "); });
  const auto refused = io::serial_port::open(loop, path, 57600, room);
  REQUIRE(std::holds_alternative<std::string>(refused));
  CHECK(std::get<std::string>(refused).starts_with(path + ": sleep (process "));
  holder.signal(SIGKILL);
  soon([&] { return end.has_value() && io::holder_of_terminal(path).empty(); });
  const opened good(loop, path);
  CHECK(io::holder_of_terminal(path).empty()); // this one's own does not count
  CHECK(io::holder_of_terminal("/dev/null").empty());
  CHECK(io::holder_of_terminal(folder.file("none")).empty());
}
