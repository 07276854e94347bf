// What was asked for and is not there: no run that lacks it ends well.
#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"

using rubicon::test::outcome;
using rubicon::test::scratch_folder;
using rubicon::test::shell;

namespace {

namespace fs = std::filesystem;

const std::string binary = RUBICON_BINARY;
const std::string small = "'" RUBICON_FIXTURES "/small.toml'";

/// Standard output, with `before` in front of the command.
outcome output_of(const std::string& arguments, const std::string& before = {}) {
  return shell("exec 2>/dev/null; " + before + " \"" + binary + "\" " + arguments);
}

struct peer_folder : scratch_folder {
  /// A file of one peer in wall time, in quotes.
  [[nodiscard]] std::string peer(const std::string& more) const {
    const auto file = path / "peer.toml";
    std::ofstream(file) << "[ecology]\nname = \"one\"\nmode = \"wall\"\nduration = \"2s\"\n"
                           "[[peer]]\nid = 1\nname = \"pc\"\n"
                        << more;
    return '\'' + file.string() + '\'';
  }
};

/// A port of loopback that somebody listens on.
class taken_port {
public:
  taken_port() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    REQUIRE(::bind(socket_, reinterpret_cast<sockaddr*>(&at), size) == 0);
    REQUIRE(::listen(socket_, 1) == 0);
    REQUIRE(::getsockname(socket_, reinterpret_cast<sockaddr*>(&at), &size) == 0);
    port_ = ntohs(at.sin_port);
  }
  ~taken_port() { ::close(socket_); }
  [[nodiscard]] std::string text() const { return std::to_string(port_); }

private:
  int socket_;
  unsigned port_ = 0;
};

bool has_violation(const nlohmann::json& report, const std::string& invariant,
                   const std::string& detail) {
  for (const auto& x : report.at("violations"))
    if (x.at("invariant") == invariant &&
        x.at("detail").get<std::string>().find(detail) != std::string::npos)
      return true;
  return false;
}

/// Sanitizers need more memory than this test leaves.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

constexpr const char* asked_for = "what was asked for is there";

} // namespace

TEST_CASE("a port that is taken ends the run with an error", "[cli]") {
  const peer_folder folder;
  const taken_port port;
  const auto x = output_of("run --json " + folder.peer("tcp.port = " + port.text() + "\n"));
  CHECK(x.status == 1);
  const auto report = nlohmann::json::parse(x.out);
  CAPTURE(x.out);
  CHECK(report.at("complete") == false);
  CHECK(report.at("reason").get<std::string>().find("port " + port.text() + " is in use") !=
        std::string::npos);
  CHECK(report.at("simulated_s") < 1.9); // it did not wait
  CHECK(has_violation(report, asked_for, "give this peer another `tcp.port`"));
}

TEST_CASE("a Bluetooth adapter that is not there ends the run with an error", "[cli][BT-01]") {
  const peer_folder folder;
  const auto x = output_of("run --json " + folder.peer("bluetooth.adapter = \"hci65000\"\n"));
  CHECK(x.status == 1);
  const auto report = nlohmann::json::parse(x.out);
  CAPTURE(x.out);
  CHECK(report.at("complete") == false);
  const std::string why = "cannot open Bluetooth adapter hci65000: ";
  CHECK(report.at("reason").get<std::string>().find(why) != std::string::npos);
  CHECK(has_violation(report, asked_for, why));
}

TEST_CASE("a peer that is away is everyday", "[cli]") {
  const peer_folder folder;
  unsigned free_port = 0;
  {
    const taken_port port;
    free_port = static_cast<unsigned>(std::stoul(port.text()));
  }
  const auto x =
      output_of("run --json " +
                folder.peer("connect = [\"tcp://127.0.0.1:" + std::to_string(free_port) + "\"]\n"));
  CAPTURE(x.out);
  CHECK(x.status == 0);
}

TEST_CASE("a component whose command is none is an error", "[cli][SVC-04]") {
  const peer_folder folder;
  const auto x = output_of(
      "run --json " +
      folder.peer(
          "[[peer.apps]]\napp = \"init\"\nlock = \"" + (folder.path / "lock").string() +
          "\"\ncomponents = [{ name = \"worker\", command = \"/nowhere/worker\", id = 2 }]\n"));
  CHECK(x.status == 1);
  CAPTURE(x.out);
  CHECK(has_violation(nlohmann::json::parse(x.out), asked_for,
                      "component worker cannot be started (status 127)"));
}

TEST_CASE("a record on a full disk is an error, with the report of the run", "[cli]") {
  const auto x = output_of("run --json --for 5s --record /dev/full " + small);
  CHECK(x.status == 1);
  const auto report = nlohmann::json::parse(x.out);
  CHECK(report.at("complete") == true);
  CHECK(has_violation(report, asked_for, "record /dev/full is not complete"));
}

TEST_CASE("files that may not grow are an error, not the end", "[cli]") {
  const peer_folder folder;
  const auto arguments =
      "run --json --for 60s --debug-dir '" + folder.path.string() + "/logs' " + small;
  const auto x = output_of(arguments, "ulimit -f 8;");
  CHECK(x.status == 1);
  CAPTURE(x.out);
  CHECK(has_violation(nlohmann::json::parse(x.out), asked_for, "debug logs in "));
}

TEST_CASE("a run without memory does not end well", "[cli][ACT-03]") {
  // From too little to begin to more than enough: whatever fails, wherever, it is told.
  const fs::path home = RUBICON_CONFIG_DIR "/home.toml";
  bool ran_out = false;
  for (int kilobytes = 28'000; kilobytes <= 36'000; kilobytes += 250) {
    CAPTURE(kilobytes);
    const auto x = shell("(ulimit -v " + std::to_string(kilobytes) + "; exec '" + binary +
                         "' run --json --for 3min '" + home.string() + "') 2>/dev/null");
    ran_out = ran_out || x.status == 1;
    if (x.status != 0)
      continue;
    const auto report = nlohmann::json::parse(x.out);
    CHECK(report.at("complete") == true);
    CHECK(report.at("simulated_s") == 180.0);
    CHECK(report.at("motes").at("joined") == 13);
  }
  if (!is_sanitized)
    CHECK(ran_out);
}

TEST_CASE("a report for an output that is closed goes nowhere else", "[cli]") {
  const peer_folder folder;
  const auto record = (folder.path / "home.rec").string();
  const auto x = shell("\"" + binary + "\" run --json --for 5s --record '" + record + "' " + small +
                       " >&- 2>/dev/null");
  CHECK(x.status == 2);
  std::ifstream stream(record);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  CHECK(text.find("violations") == std::string::npos); // no report among the records
}

TEST_CASE("a reader that goes away is an error", "[cli]") {
  const auto x =
      shell("bash -c '{ sleep 0.5; \"$0\" run --json --for 5s \"$1\"; } 2>/dev/null | :; "
            "exit ${PIPESTATUS[0]}' '" +
            binary + "' " + small);
  CHECK(x.status == 2); // told by the write, not by a signal
}
