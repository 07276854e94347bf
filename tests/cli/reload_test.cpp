// A run in wall time whose file changes under it.
#include <csignal>
#include <fstream>
#include <string>

#include "edge.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// @param every of the sampler
std::string home(const std::string& every, const std::string& more = "",
                 const std::string& seed = "1") {
  return "[ecology]\nname = \"home\"\nmode = \"wall\"\nduration = \"5min\"\nseed = " + seed +
         "\n[mote_type.climate]\ntype = 101\n"
         "transducers.temperature = { model = \"constant\", value = 20, resolution = 0.1 }\n"
         "apps = [{ app = \"sampler\", transducers = [\"temperature\"], every = \"" +
         every +
         "\" }]\n[[island]]\nid = 20\nname = \"kitchen\"\n"
         "mote = [{ id = 2, name = \"stove\", type = \"climate\", position_m = [1, 0] }]\n" +
         more;
}

/// `rubicon run --reload` of a file that is written anew.
struct followed_run {
  explicit followed_run(std::vector<std::string> options = {}) {
    write(home("10s"));
    std::vector<std::string> words{"run", folder.file("home.toml"), "--json", "--reload"};
    words.insert(words.end(), options.begin(), options.end());
    run.emplace(loop, words);
    await("kitchen/stove");
  }

  void write(const std::string& text) const { std::ofstream(folder.file("home.toml")) << text; }

  void reload(const std::string& text) {
    write(text);
    run->process->signal(SIGHUP);
  }

  /// Until it has said so on standard error.
  void await(const std::string& text) {
    INFO(text);
    test::run(loop, [&] { return run->err.find(text) != std::string::npos || run->end; });
    REQUIRE(run->err.find(text) != std::string::npos);
  }

  json finish() {
    run->process->signal(SIGINT);
    run->await_end();
    CHECK(run->end->status == 130);
    return json::parse(run->out);
  }

  scratch_folder folder;
  io::loop loop;
  std::optional<program> run;
};

} // namespace

TEST_CASE("a run follows its file as far as it can", "[cli][ACT-10]") {
  followed_run x;
  x.reload(home("300ms"));
  x.await("sampler 1: every 300 ms instead of 10 s");
  x.await("home.toml was read again: 1 change, 0 planned, 0 refused");

  x.reload(
      home("300ms", "[[fault]]\nat = \"4min\"\nkind = \"crash\"\nmote = \"kitchen/stove\"\n", "2"));
  x.await("home.toml:5:8: `ecology.seed` differs, and cannot change while an ecology runs");
  x.await("home.toml was read again: 0 changes, 1 planned, 1 refused");

  x.reload("[ecology\n");
  x.await("was read again: 0 changes, 0 planned, 1 refused");
  const auto report = x.finish();
  CHECK(report["violations"].empty());
  CHECK(report["seed"] == 1);
}

TEST_CASE("a fault that joins the plan happens at its time", "[cli][ACT-10]") {
  followed_run x({"--speed", "10"});
  x.reload(home("10s", "[[fault]]\nevery = \"20s\"\nkind = \"crash\"\nmote = \"kitchen/stove\"\n"));
  x.await("1 planned, 0 refused");
  x.await("joined again, life 2");
  CHECK(x.finish()["actors"]["restarted"] >= 1);
}

TEST_CASE("only a run in wall time can follow its file", "[cli][ACT-10]") {
  const scratch_folder folder;
  std::ofstream(folder.file("home.toml")) << home("10s");
  io::loop loop;
  program run(loop, {"run", folder.file("home.toml"), "--mode", "virtual", "--reload"});
  run.await_end();
  CHECK(run.end->status == 2);
  CHECK(run.err == "--reload: a virtual run ends before you can act: add --mode wall\n");
}
