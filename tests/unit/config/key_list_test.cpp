#include <variant>

#include "config/toml/table_reader.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::config;

namespace {

struct pump {
  std::uint16_t channel = 7;
  duration every = 1s;
};

auto pump_keys(bool needs_channel) {
  return keys::of(keys::required_if(needs_channel, "channel", &pump::channel,
                                    whole<std::uint16_t>{1, 9}, "required with a valve"),
                  keys::optional("every", &pump::every, time_span{}, "its period"));
}

/// What was read, what was wrong, and which keys were good.
struct outcome {
  pump value;
  std::vector<problem> problems;
  bool channel_is_good = false;
  bool every_is_good = false;
};

outcome read(std::string_view toml, bool needs_channel) {
  const auto parsed = parse(toml, "a.toml");
  reading shared;
  table_reader in(std::get<node>(parsed), "[pump]", shared);
  outcome out;
  in.all(out.value, pump_keys(needs_channel));
  in.finish();
  out.channel_is_good = in.is_good("channel");
  out.every_is_good = in.is_good("every");
  out.problems = shared.problems.of_file("a.toml");
  return out;
}

} // namespace

TEST_CASE("a key of a list is required only under its condition", "[config][GEN-06]") {
  const auto missing = read("every = \"2s\"", true);
  REQUIRE(missing.problems.size() == 1);
  CHECK(missing.problems[0].message == "`channel` is missing in [pump]");
  const auto not_needed = read("every = \"2s\"", false);
  CHECK(not_needed.problems.empty());
  CHECK(not_needed.value.channel == 7);
  CHECK(read("channel = 3", false).value.channel == 3);
}

TEST_CASE("a key is good if it is in the file and its value can be read", "[config][GEN-06]") {
  const auto x = read("channel = 3\nevery = 5", true);
  CHECK(x.channel_is_good);
  CHECK_FALSE(x.every_is_good); // a number is no time
  CHECK(x.problems.size() == 1);
  CHECK(x.value.every == 1s);
  CHECK_FALSE(read("every = \"1s\"", false).channel_is_good);
}

TEST_CASE("a conditional key is described neither as required nor with a default",
          "[config][ACT-13]") {
  reading shared;
  shared.walks = true;
  table_reader in(no_keys, "[pump]", shared);
  pump x;
  in.all(x, pump_keys(true));
  const auto* channel = in.found().find("channel");
  REQUIRE(channel != nullptr);
  CHECK_FALSE(channel->is_required);
  CHECK(channel->standard.empty());
  CHECK(channel->meaning == "required with a valve");
  CHECK(in.found().find("every")->standard == "\"1s\"");
}
