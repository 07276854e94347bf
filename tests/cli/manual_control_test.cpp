// What the live page may do to a run.
#include <string>

#include "cli/options/parse_command_line.hpp"
#include "cli/run/live_page.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

TEST_CASE("a tuple that cannot be set by hand is refused with the reason", "[cli][page]") {
  const bool kernels = GENERATE(false, true);
  manual_control manual(deploy::bundle{}, {}, {"robot"}, kernels);
  const auto controls = manual.controls();
  const auto refusal = [&](const std::string& owner, const std::string& key) {
    const auto done = controls->set_tuple(owner, key, "x");
    return done.ok ? std::string() : done.text;
  };
  CHECK(refusal("robot", "a.note") == "");
  CHECK(refusal("robot", "*.*").starts_with("this is a pattern"));
  CHECK(refusal("robot", "a.b.c.d.e.f.g.h.i").starts_with("not a key: "));
  CHECK(refusal("robot", "a*").starts_with("not a key: "));
  CHECK(refusal("robot", std::string(200, 'k')).starts_with("not a key: "));
  CHECK(refusal("robot", "") == "a tuple needs a key");
  CHECK(refusal("nobody", "a") == "there is no peer `nobody`");
  CHECK(refusal("robot", "kernel.name").empty() == kernels);
  CHECK(refusal("robot", "Kernel.do-quit").empty() == kernels);
  int set = 0;
  const auto results = manual.perform({{},
                                       [&](const auto&, const auto&, const auto&) {
                                         ++set;
                                         return true;
                                       }},
                                      instant{});
  CHECK(set == (kernels ? 3 : 1));
}

TEST_CASE("kernels are steered by hand only where that is said", "[cli][page]") {
  const auto run = [](const char* control) {
    const char* words[] = {"rubicon", "run", "home.toml", "--view", "0", control};
    const auto x = parse_command_line(words);
    REQUIRE(std::holds_alternative<run_command>(x));
    return std::get<run_command>(x).watch;
  };
  CHECK(run("--control").control);
  CHECK(!run("--control").control_kernel);
  CHECK(run("--control=kernel").control);
  CHECK(run("--control=kernel").control_kernel);
  const char* wrong[] = {"rubicon", "run", "home.toml", "--view", "0", "--control=all"};
  CHECK(std::holds_alternative<refused_command>(parse_command_line(wrong)));
}
