// The commands that look into a network, as a user meets them, against two peers on loopback.
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include <nlohmann/json.hpp>

#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utmp.h>

#include "peer/standalone.hpp"
#include "support/catch.hpp"
#include "support/shell.hpp"

using namespace rubicon;
using rubicon::test::outcome;
using rubicon::test::shell;

namespace {

/// Peer 7 with a few tuples, driven on a thread of its own from first to last.
class lonely_peer {
public:
  /// @param beside the place of another one, whom it joins as peer 9 of the same name
  explicit lonely_peer(std::string beside = {}) : beside_(std::move(beside)) {
    thread_ = std::thread([this] { drive(); });
    while (port_ == 0)
      std::this_thread::yield();
  }
  ~lonely_peer() {
    over_ = true;
    thread_.join();
  }

  [[nodiscard]] std::string at() const {
    return " --connect 127.0.0.1:" + std::to_string(port_) + ' ';
  }
  [[nodiscard]] std::string url() const { return "tcp://127.0.0.1:" + std::to_string(port_); }

private:
  void drive() {
    io::loop loop;
    peer::standalone_config config;
    config.kernel.network.id = peer_id{beside_.empty() ? 7 : 9};
    if (!beside_.empty())
      config.kernel.network.connections.always = {beside_};
    config.kernel.network.name = "lonely";
    config.kernel.network.network = "rubicon";
    config.links.first_port = 0;
    auto opened = peer::standalone::open(loop, config);
    auto& peer = *std::get<std::unique_ptr<peer::standalone>>(opened);
    static_cast<void>(peer.tuples().set("room.temp", peis::text_content("21.5")));
    if (!beside_.empty())
      static_cast<void>(peer.tuples().subscribe(peer_id{7}, "room.temp"));
    else
      static_cast<void>(peer.tuples().set("room.scan", peis::binary_content(bytes{0, 255})));
    // As a proxy's input: the lamp can be switched on, and nothing else.
    static_cast<void>(peer.tuples().set("lamp.switch.deadline", peis::text_content("5.0")));
    static_cast<void>(peer.tuples().set("lamp.switch.outcome", peis::text_content("on failed")));
    static_cast<void>(peer.tuples().subscribe(peer_id{7}, "lamp.switch", [&peer](const auto& x) {
      const std::string word(x->text());
      if (word != "forever")
        static_cast<void>(peer.tuples().set(
            "lamp.switch.outcome",
            peis::text_content(word + (word == "on" ? " acknowledged" : " refused"))));
    }));
    port_ = *peer.links().port();
    while (!over_)
      peer.step(10ms);
    peer.leave();
  }

  std::string beside_;
  std::atomic<unsigned> port_ = 0;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

const std::string rubicon_binary = RUBICON_BINARY;

/// The binary in a terminal of 80 columns and 24 lines.
class in_terminal {
public:
  explicit in_terminal(const std::string& arguments) {
    const winsize size{24, 80, 0, 0};
    int terminal = -1;
    REQUIRE(::openpty(&master_, &terminal, nullptr, nullptr, &size) == 0);
    REQUIRE(::tcgetattr(master_, &before_) == 0);
    const auto command = "exec '" + rubicon_binary + "' " + arguments;
    child_ = ::fork();
    REQUIRE(child_ >= 0);
    if (child_ == 0) {
      ::setenv("TERM", "xterm", 1);
      ::unsetenv("COLUMNS");
      ::login_tty(terminal);
      ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      ::_exit(127);
    }
    terminal_ = terminal; // held open: what was set stays to be seen
  }
  ~in_terminal() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
    ::close(terminal_);
    ::close(master_);
  }
  in_terminal(const in_terminal&) = delete;
  in_terminal& operator=(const in_terminal&) = delete;

  /// Reads until it has shown these words. @returns false if it does not within a while
  bool shows(const std::string& words) {
    for (int quiet = 0; quiet < 200 && shown_.find(words) == std::string::npos; ++quiet)
      read_some();
    return shown_.find(words) != std::string::npos;
  }
  void press(char key) const { REQUIRE(::write(master_, &key, 1) == 1); }
  /// @returns its exit status
  int wait() {
    int how = 0;
    pid_t ended = 0;
    for (int i = 0; i < 200 && ended == 0; ++i) {
      read_some();
      ended = ::waitpid(child_, &how, WNOHANG);
    }
    REQUIRE(ended == child_);
    child_ = -1;
    read_some();
    REQUIRE(WIFEXITED(how));
    return WEXITSTATUS(how);
  }
  [[nodiscard]] bool is_as_before() const {
    termios now{};
    return ::tcgetattr(master_, &now) == 0 && now.c_lflag == before_.c_lflag &&
           now.c_cc[VSUSP] == before_.c_cc[VSUSP] && now.c_cc[VMIN] == before_.c_cc[VMIN];
  }
  [[nodiscard]] bool echoes() const {
    termios now{};
    return ::tcgetattr(master_, &now) == 0 && (now.c_lflag & ECHO) != 0;
  }
  [[nodiscard]] const std::string& shown() const { return shown_; }

private:
  void read_some() {
    pollfd x{master_, POLLIN, 0};
    if (::poll(&x, 1, 100) != 1)
      return;
    std::array<char, 4096> block{};
    const auto size = ::read(master_, block.data(), block.size());
    if (size > 0)
      shown_.append(block.data(), static_cast<std::size_t>(size));
  }

  int master_ = -1;
  int terminal_ = -1;
  pid_t child_ = -1;
  termios before_{};
  std::string shown_;
};

outcome standard_output(const std::string& arguments) {
  return shell('"' + rubicon_binary + "\" " + arguments + " 2>/dev/null");
}

outcome standard_error(const std::string& arguments) {
  return shell('"' + rubicon_binary + "\" " + arguments + " 2>&1 >/dev/null");
}

} // namespace

TEST_CASE("tuples of a running peer are read and written", "[cli][SVC-07][SVC-08]") {
  const lonely_peer peer;
  CHECK(standard_output("tuples get room.temp --owner 7" + peer.at()).out == "21.5\n");
  CHECK(standard_output("tuples get room.scan --owner 7" + peer.at()).out == "00ff\n");
  CHECK(standard_output("tuples set room.temp 22 --owner 7" + peer.at()).status == 0);
  CHECK(standard_output("tuples append room.temp .5 --owner 7" + peer.at()).status == 0);
  const auto x = nlohmann::json::parse(
      standard_output("tuples get room.temp --owner 7 --json" + peer.at()).out);
  CHECK(x.at("value") == "22.5");
  CHECK(x.at("owner") == 7);
  const auto all = nlohmann::json::parse(standard_output("tuples ls --json" + peer.at()).out);
  REQUIRE(all.size() == 4); // without kernel.*
  CHECK(all[2].at("key") == "room.scan");
  CHECK(all[2].at("value_hex") == "00ff");
  const auto table = standard_output("tuples ls 'room.*'" + peer.at());
  CHECK(table.status == 0);
  CHECK(table.out.find("22.5") != std::string::npos);
}

TEST_CASE("a file, or standard input, is the value of a tuple", "[cli][SVC-08]") {
  const lonely_peer peer;
  const auto set = [&](const std::string& before, const std::string& value) {
    return shell(before + '"' + rubicon_binary + "\" tuples set room.temp " + value + " --owner 7" +
                 peer.at() + " 2>&1");
  };
  const auto value = [&] {
    return standard_output("tuples get room.temp --owner 7" + peer.at()).out;
  };
  CHECK(set("printf '\\001\\377' | ", "-").status == 0);
  CHECK(value() == "01ff\n");
  CHECK(set("", "@@home").status == 0);
  CHECK(value() == "@home\n");
  CHECK(standard_output("tuples set room.temp --owner 7" + peer.at() + "-- -5").status == 0);
  CHECK(value() == "-5\n");
  const auto none = set("", "@/nowhere/file");
  CHECK(none.status == 1);
  CHECK(none.out.find("/nowhere/file cannot be opened: No such file") != std::string::npos);
}

TEST_CASE("a script waits until a tuple has a value", "[cli][SVC-08]") {
  const lonely_peer peer;
  const auto wait = [&](const std::string& words) {
    return shell('"' + rubicon_binary + "\" tuples wait " + words + peer.at() + " 2>&1");
  };
  CHECK(wait("room.temp").out == "21.5\n");
  CHECK(wait("room.temp '> 20' --owner 7").out == "21.5\n");
  const auto late = wait("room.temp '> 30' --timeout 700ms");
  CHECK(late.status == 1);
  CHECK(late.out.find("tuple `room.temp` of peer 7 is 21.5") != std::string::npos);
  const auto none = wait("room.light --timeout 700ms");
  CHECK(none.status == 1);
  CHECK(none.out.find("no peer has a tuple `room.light`") != std::string::npos);
  outcome waited;
  std::thread other([&] { waited = wait("room.temp '>= 30' --timeout 20s"); });
  CHECK(standard_output("tuples set room.temp 31 --owner 7" + peer.at()).status == 0);
  other.join();
  CHECK(waited.status == 0);
  CHECK(waited.out == "31\n");
}

TEST_CASE("setting a proxy's input waits for its outcome, if asked to", "[cli][SVC-07][IF-07]") {
  const lonely_peer peer;
  const auto set = [&](const std::string& words) {
    return shell('"' + rubicon_binary + "\" tuples set " + words + " --owner 7" + peer.at() +
                 " 2>&1");
  };
  const auto good = set("lamp.switch on --wait");
  CHECK(good.status == 0);
  CHECK(good.out == "acknowledged\n"); // not the older `failed`
  const auto bad = set("lamp.switch 'half on' --wait");
  CHECK(bad.status == 1);
  CHECK(bad.out == "refused\n");
  const auto json = set("lamp.switch on --wait --json");
  CHECK(json.status == 0);
  CHECK(nlohmann::json::parse(json.out).at("outcome") == "acknowledged");
  const auto none = set("room.temp 22 --wait --timeout 300ms");
  CHECK(none.status == 1);
  CHECK(none.out.find("room.temp.deadline") != std::string::npos);
  CHECK(standard_output("tuples get room.temp --owner 7" + peer.at()).out == "21.5\n");
  const auto late = set("lamp.switch forever --wait --timeout 500ms");
  CHECK(late.status == 1);
  CHECK(late.out.find("no") != std::string::npos);
  CHECK(set("lamp.switch on").out.empty());
}

TEST_CASE("a tuple of a running peer is deleted", "[cli][SVC-07]") {
  const lonely_peer peer;
  CHECK(standard_output("tuples delete room.temp --owner 7" + peer.at()).status == 0);
  CHECK(standard_output("tuples get room.temp --owner 7 --timeout 300ms" + peer.at()).status == 1);
  const auto x = standard_output("tuples delete room.scan --owner 7 --json" + peer.at());
  CHECK(nlohmann::json::parse(x.out).at("acknowledged") == true);
  CHECK(standard_error("tuples ls 'room.*' --timeout 300ms" + peer.at()).out ==
        "rubicon: no peer has a tuple `room.*`\n");
  CHECK(standard_error("tuples delete room.temp --owner 8 --timeout 300ms" + peer.at()).status ==
        1);
}

TEST_CASE("meta tuples are shown with what they point at, and pointed elsewhere", "[cli][SVC-07]") {
  const lonely_peer peer;
  const auto meta = [&](const std::string& words) {
    return standard_output("tuples meta " + words + " --owner 7" + peer.at());
  };
  CHECK(meta("mi-light room.temp").status == 0);
  CHECK(meta("mi-light").out == "7 room.temp  21.5\n");
  const auto x = nlohmann::json::parse(meta("mi-light --json").out);
  CHECK(x.at("key") == "mi-light");
  CHECK(x.at("target").at("key") == "room.temp");
  CHECK(x.at("target").at("value") == "21.5");
  CHECK(meta("mi-light room.fan --at 9").status == 0);
  CHECK(meta("mi-light --timeout 300ms").out == "9 room.fan  (no such tuple)\n");
  CHECK(meta("mi-light --nowhere").status == 0);
  CHECK(meta("mi-light").out == "nowhere\n");
  CHECK(standard_error("tuples meta room.temp --owner 7" + peer.at()).out ==
        "rubicon: tuple `room.temp` of peer 7 is not a meta tuple\n");
  CHECK(meta("mi-light room.temp --nowhere").status == 2);
}

TEST_CASE("changes are watched until enough have come", "[cli][SVC-07]") {
  const lonely_peer peer;
  const auto x = standard_output("tuples watch 'room.*' --count 2 --for 20s --json" + peer.at());
  CHECK(x.status == 0);
  const auto end = x.out.find('\n');
  CHECK(nlohmann::json::parse(x.out.substr(0, end)).at("owner") == 7);
  CHECK(nlohmann::json::parse(x.out.substr(end)).at("owner") == 7);
  CHECK(standard_error("tuples watch nothing --count 1 --for 100ms" + peer.at()).status == 1);
}

TEST_CASE("hosts and ways to them are shown", "[cli][API-01][API-12]") {
  const lonely_peer peer;
  const auto hosts = nlohmann::json::parse(standard_output("hosts --json" + peer.at()).out);
  REQUIRE(hosts.size() == 1);
  CHECK(hosts[0].at("id") == 7);
  CHECK(hosts[0].at("name").get<std::string>().starts_with("lonely@"));
  CHECK(standard_output("hosts" + peer.at()).out.find("lonely@") != std::string::npos);
  const auto way =
      nlohmann::json::parse(standard_output("route 7 --id 60123 --json" + peer.at()).out);
  CHECK(way.at("route") == nlohmann::json({60123, 7, 60123}));
  const auto ping = standard_output("ping 7 --count 2" + peer.at());
  CHECK(ping.status == 0);
  CHECK(ping.out.find("2 hops there and back") != std::string::npos);
}

TEST_CASE("what cannot be done is told in one line, with status 1", "[cli]") {
  const lonely_peer peer;
  const auto one_line = [](const outcome& x, const std::string& text) {
    CAPTURE(x.out);
    CHECK(x.status == 1);
    CHECK(x.out == "rubicon: " + text + '\n');
  };
  const auto quick = " --timeout 300ms" + peer.at();
  one_line(standard_error("tuples get room.fan --owner 7" + quick),
           "peer 7 has no tuple `room.fan`");
  one_line(standard_error("tuples get room.fan" + quick), "no peer has a tuple `room.fan`");
  const std::string lists = "; rubicon hosts lists them";
  one_line(standard_error("tuples set a b --owner 8" + quick),
           "no peer 8 in the network `rubicon`" + lists);
  one_line(standard_error("ping 8" + quick), "no peer 8 in the network `rubicon`" + lists);
  one_line(standard_error("route nobody" + quick),
           "no peer is named `nobody` in the network `rubicon`" + lists);
  one_line(standard_error("tuples set a b" + quick),
           "no peer has a tuple `a`; give its owner with --owner PEER");
  one_line(
      standard_error("hosts --connect 127.0.0.1:1"),
      "127.0.0.1:1: Connection refused; nobody listens there: a peer accepts links in wall time if "
      "its file has tcp = true");
  const auto other = standard_error("hosts --network other" + quick);
  CHECK(other.status == 1);
  CHECK(other.out.find("is not a peer of the network `other`") != std::string::npos);
}

TEST_CASE("an owner goes by its name, or by being the only one", "[cli][SVC-08]") {
  const lonely_peer peer;
  CHECK(standard_output("tuples get room.temp --owner lonely" + peer.at()).out == "21.5\n");
  CHECK(standard_output("tuples get room.temp" + peer.at()).out == "21.5\n");
  CHECK(standard_output("tuples set room.temp 23" + peer.at()).status == 0);
  CHECK(standard_output("tuples append room.temp .5 --owner lonely" + peer.at()).status == 0);
  CHECK(standard_output("tuples get room.temp --owner 7" + peer.at()).out == "23.5\n");
  // An input of a proxy that nobody has written yet belongs to who tells its deadline.
  CHECK(standard_output("tuples set lamp.switch on --wait" + peer.at()).out == "acknowledged\n");
  CHECK(standard_output("route lonely" + peer.at()).status == 0);
  CHECK(standard_output("tuples delete room.scan" + peer.at()).status == 0);

  const lonely_peer other(peer.url());
  const auto both = standard_error("tuples set room.temp 9" + peer.at());
  CHECK(both.status == 1);
  CAPTURE(both.out);
  CHECK(both.out.starts_with("rubicon: several peers have a tuple `room.temp`: 7 (lonely@"));
  CHECK(both.out.find(", 9 (lonely@") != std::string::npos);
  CHECK(both.out.find("--owner PEER") != std::string::npos);
  const auto called = standard_error("tuples set room.temp 9 --owner lonely" + peer.at());
  CHECK(called.status == 1);
  CHECK(called.out.starts_with("rubicon: several peers are named `lonely`: 7 ("));
  CHECK(standard_output("tuples get room.temp --owner 7" + peer.at()).out == "23.5\n");
}

TEST_CASE("the graph of a network shows who subscribes to whom", "[cli][SVC-07]") {
  const lonely_peer peer;
  const lonely_peer other(peer.url());
  CHECK(standard_output("tuples meta mi-light room.temp --owner 9 --at 7" + peer.at()).status == 0);
  const auto x = nlohmann::json::parse(standard_output("tuples graph --json" + peer.at()).out);
  CAPTURE(x.dump(1));
  CHECK(x.at("peers").size() == 2);
  bool is_subscribed = false;
  bool points = false;
  for (const auto& each : x.at("tuples")) {
    if (each.at("owner") == 7 && each.at("key") == "room.temp")
      is_subscribed = each.at("subscribers") == nlohmann::json({9});
    if (each.at("owner") == 9 && each.at("key") == "mi-light")
      points = each.at("points_at").at("owner") == 7;
  }
  CHECK(is_subscribed);
  CHECK(points);
  const auto dot = standard_output("tuples graph --dot" + peer.at()).out;
  CHECK(dot.find(R"("7 room.temp" -> "peer 9")") != std::string::npos);
  CHECK(standard_output("tuples graph" + peer.at()).out.find("Meta tuples") != std::string::npos);
}

TEST_CASE("pictures of a network come one after the other into a pipe", "[cli][SVC-07]") {
  const lonely_peer peer;
  const auto x = standard_output("top --json --every 200ms --count 2" + peer.at());
  CHECK(x.status == 0);
  const auto end = x.out.find('\n');
  for (const auto& line : {x.out.substr(0, end), x.out.substr(end)}) {
    const auto picture = nlohmann::json::parse(line);
    REQUIRE(picture.at("peers").size() == 1);
    CHECK(picture.at("peers")[0].at("id") == 7);
    CHECK(picture.at("peers")[0].at("tuples") == 4);
  }
  const auto text = standard_output("top --once --every 200ms" + peer.at());
  CHECK(text.status == 0);
  CHECK(text.out.find("lonely@") != std::string::npos);
  CHECK(text.out.find('\033') == std::string::npos);
}

TEST_CASE("a picture fills the terminal until q, and leaves it as it was", "[cli][SVC-07]") {
  const lonely_peer peer;
  in_terminal x("top --every 200ms" + peer.at());
  REQUIRE(x.shows("lonely@"));
  CHECK(!x.echoes());
  CHECK(x.shown().find("\033[?1049h") != std::string::npos);
  x.press('q');
  CHECK(x.wait() == 0);
  CHECK(x.shown().ends_with("\033[?25h\033[?1049l"));
  CHECK(x.is_as_before());
}

TEST_CASE("Ctrl-C ends a picture as well", "[cli][SVC-07]") {
  const lonely_peer peer;
  in_terminal x("top --every 200ms" + peer.at());
  REQUIRE(x.shows("lonely@"));
  x.press('\003');
  CHECK(x.wait() == 130);
  CHECK(x.shown().ends_with("\033[?25h\033[?1049l"));
  CHECK(x.is_as_before());
}

TEST_CASE("a picture ends with the link that it came by", "[cli][SVC-07]") {
  std::optional<lonely_peer> peer(std::in_place);
  in_terminal x("top --every 200ms" + peer->at());
  REQUIRE(x.shows("lonely@"));
  peer.reset();
  CHECK(x.wait() == 1);
  CHECK(x.shown().find("is gone") != std::string::npos);
  CHECK(x.is_as_before());
}
