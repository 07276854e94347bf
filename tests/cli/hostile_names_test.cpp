// Whatever octets a remote peer gives itself, its tuples and their values: no terminal and no log
// gets them as they are.
#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <variant>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "peer/standalone.hpp"
#include "support/catch.hpp"
#include "support/shell.hpp"

using namespace rubicon;
using rubicon::test::outcome;
using rubicon::test::shell;

namespace {

namespace fs = std::filesystem;

/// Clears the screen, forges a line of a log, rings, sets a title, is no UTF-8, is a C1 control,
/// turns the text round, is a program on a page.
const std::string evil = "x\033[2J\n1.000000 E forged event=failed\r\a\033]0;t\a\xff\xc2\x9b"
                         "31m\xe2\x80\xae<script>\"'";

/// A peer that says so wherever it can, driven on a thread of its own.
class hostile_peer {
public:
  hostile_peer() {
    thread_ = std::thread([this] { drive(); });
    while (port_ == 0)
      std::this_thread::yield();
  }
  ~hostile_peer() {
    over_ = true;
    thread_.join();
  }

  [[nodiscard]] std::string at() const { return "127.0.0.1:" + std::to_string(port_); }

private:
  void drive() {
    io::loop loop;
    peer::standalone_config config;
    config.kernel.network.id = peer_id{7};
    config.kernel.network.network = "rubicon";
    config.kernel.network.name = "n" + evil;
    config.kernel.network.host_name = "h" + evil;
    config.kernel.user = "u" + evil;
    config.links.first_port = 0;
    auto opened = peer::standalone::open(loop, config);
    auto& peer = *std::get<std::unique_ptr<peer::standalone>>(opened);
    for (const std::string key : {"devices", "k", "things.interface"})
      static_cast<void>(peer.tuples().set(key, peis::text_content(evil)));
    auto key = "room.k" + evil;
    while (key.rfind('.') > 4) // it is to have two parts
      key.erase(key.rfind('.'), 1);
    static_cast<void>(peer.tuples().set(key, peis::text_content(evil)));
    static_cast<void>(
        peer.tuples().set("room.long", peis::text_content(std::string(20'000, 'y') + evil)));
    port_ = *peer.links().port();
    while (!over_)
      peer.step(10ms);
    peer.leave();
  }

  std::atomic<unsigned> port_ = 0;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

/// Both outputs of the binary.
outcome said(const std::string& arguments) {
  return shell("timeout 60 '" RUBICON_BINARY "' " + arguments + " 2>&1");
}

void check_harmless(const std::string& text) {
  CHECK(text.find('\033') == std::string::npos);
  CHECK(text.find('\r') == std::string::npos);
  CHECK(text.find('\a') == std::string::npos);
  CHECK(text.find('\xff') == std::string::npos);
  CHECK(text.find("\xc2\x9b") == std::string::npos);
  CHECK(text.find("\xe2\x80\xae") == std::string::npos);
  CHECK(("\n" + text).find("\n1.000000 E forged") == std::string::npos);
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

} // namespace

TEST_CASE("the commands of a network show hostile names harmlessly", "[cli][SVC-07][SVC-08]") {
  const hostile_peer peer;
  const auto to = " --timeout 3s --connect " + peer.at();
  for (const std::string command :
       {"hosts", "tuples ls --all", "tuples ls 'room.*'", "tuples get k --owner 7", "tuples get k",
        "tuples watch 'room.*' k --count 3 --for 10s", "route 7", "ping 7 --count 1",
        "tuples get nothing --owner 7", "tuples graph --all", "tuples set k x --owner nobody",
        "top --count 2 --every 300ms"}) {
    CAPTURE(command);
    check_harmless(said(command + to).out);
    const auto json = said(command + " --json" + to);
    check_harmless(json.out);
  }
  const auto shown = said("tuples get k --owner 7" + to);
  CHECK(shown.out.find(R"(x\x1b[2J\n1.000000 E forged)") != std::string::npos); // and is all there
  const auto json = nlohmann::json::parse(said("tuples get k --owner 7 --json" + to).out);
  CHECK(json.at("value").get<std::string>().starts_with("x\033[2J\n"));
}

TEST_CASE("a run shows and logs hostile names harmlessly", "[cli][NFR-01]") {
  const hostile_peer peer;
  const auto folder = fs::temp_directory_path() / ("rubicon-hostile-" + std::to_string(::getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::ofstream(folder / "one.toml") << R"(
ecology = { name = "one", mode = "wall", duration = "4s" }
[[peer]]
id = 1
name = "pc"
connect = ["tcp://)" << peer.at() << R"("]
[[peer.apps]]
app = "collector"
keys = ["*", "*.*"]
[[peer]]
id = 7
name = "twin"
connect = ["tcp://)" << peer.at() << R"("]
)";
  const auto file = '\'' + (folder / "one.toml").string() + '\'';
  const auto record = '\'' + (folder / "one.rec").string() + '\'';
  const auto page = folder / "one.html";
  const auto x =
      said("run --log trace --debug-dir '" + (folder / "logs").string() + "' --record " + record +
           " --report '" + page.string() + "' --csv '" + (folder / "data").string() + "' " + file);
  check_harmless(text_of(page));
  CHECK(text_of(page).ends_with("</html>\n"));
  CHECK(text_of(page).find("<script") == std::string::npos);
  check_harmless(x.out);
  CHECK(x.out.find("link") != std::string::npos); // they have met
  bool was_heard = false;
  for (const auto& log : fs::directory_iterator(folder / "logs")) {
    const auto text = text_of(log.path());
    CAPTURE(log.path());
    check_harmless(text);
    was_heard = was_heard || text.find("forged") != std::string::npos;
  }
  CHECK(was_heard);
  const auto json = said("run --json --log off --for 3s " + file);
  check_harmless(json.out);
  CHECK(nlohmann::json::parse(json.out).at("ecology") == "one");
  for (const std::string what : {"", " k@7", " k --all", " k --json", " --json"})
    check_harmless(said("explain " + record + what).out);
  fs::remove_all(folder);
}

TEST_CASE("files with hostile names are refused and summed up harmlessly", "[cli][GEN-06]") {
  const auto file =
      fs::temp_directory_path() / ("rubicon-evil-" + std::to_string(::getpid()) + ".toml");
  const auto check = [&](const std::string& toml) {
    std::ofstream(file) << toml;
    CAPTURE(toml);
    for (const std::string command : {"check ", "run --for 1s ", "swarm --seeds 1..1 --for 1s "})
      check_harmless(said(command + '\'' + file.string() + '\'').out);
  };
  const std::string escaped = R"(x\u001b[2J\n1.000000 E forged\r\u009b31m\u202e)"; // as TOML has it
  check("[ecology]\nname = \"" + escaped + "\"\nnetwork = \"" + escaped + "\"\n");
  check("[ecology]\nname = \"a\"\n\"" + escaped + "\" = 1\n");
  check("[ecology]\nname = \"a\"\nduration = \"" + escaped + "\"\n[[peer]]\nid = 1\nname = \"" +
        escaped + "\"\n");
  check("[ecology]\nname = " + evil + "\n");
  check("# " + evil + "\n");
  fs::remove(file);
}
