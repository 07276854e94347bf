// Requests of a program that steers a run, and their answers; the run is a stand-in.
#include "steering/session.hpp"

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::steering;
using nlohmann::json;

namespace {

/// Does nothing but remember what was requested.
struct stand_in {
  instant now;
  std::vector<std::pair<std::string, instant>> faults;
  std::vector<std::pair<send_request, std::uint32_t>> sent;
  steering::session session{
      {.name = "home", .seed = 7, .length = 60s, .peers = {"pc"}, .motes = {}},
      {.run_until = [this](instant until) { return now = until; },
       .tuple = [](const get_request& x) -> std::optional<std::string> {
         return x.key == "a.b" ? std::optional<std::string>("5") : std::nullopt;
       },
       .set_tuple = [](const set_request&) { return std::string(); },
       .fault =
           [this](const std::string& words, instant at) {
             faults.emplace_back(words, at);
             return std::string(words == "wrong" ? "no such kind" : "");
           },
       .send =
           [this](const send_request& x, std::uint32_t number) {
             sent.emplace_back(x, number);
             return std::string(x.mote == "kitchen/fan" ? "" : "there is no such mote");
           },
       .table = [](const std::string& words,
                   const std::string& at) { return "\n[[fault]] " + words + " at " + at + '\n'; },
       .look = [] { return report::run_sample(); },
       .report = [] { return std::string("{}"); },
       .finish = [] { return std::string("{\"seed\":7}"); }}};

  json ask(const std::string& line) { return json::parse(session.on_line(line)); }
};

} // namespace

TEST_CASE("time goes on as far as a step requests, and no further than the run", "[steering]") {
  stand_in run;
  CHECK(run.ask(R"({"do":"step","for":1.5})")["now"] == 1.5);
  CHECK(run.now == instant(1500ms));
  CHECK(run.ask(R"({"do":"step","until":1})")["ok"] == false);
  const auto last = run.ask(R"({"do":"step","for":100})");
  CHECK(last["now"] == 60);
  CHECK(last["over"] == true);
}

TEST_CASE("a malformed request is refused, and says where and why", "[steering]") {
  stand_in run;
  const auto why = [&](const std::string& line) {
    const auto answer = run.ask(line);
    CHECK(answer["ok"] == false);
    return answer["why"].get<std::string>();
  };
  CHECK(why("{\"do\":").find("no JSON at character ") == 0);
  CHECK(why("5").find("a request is an object") == 0);
  CHECK(why(R"({"do":"stop"})").find("there is no request `stop`") == 0);
  CHECK(why(R"({"do":"step"})") == "a step needs either `for` or `until`");
  CHECK(why(R"({"do":"step","for":-1})").find("`for` must be") == 0);
  CHECK(why(R"({"do":"step","for":1e999})") == "a number is too large");
  CHECK(why(R"({"do":"step","for":1,"ever":2})").find("`ever` is not a member") == 0);
  CHECK(why(R"({"do":"get","peer":"robot","key":"a"})") == "there is no peer `robot`");
  CHECK(why(R"({"do":"get","peer":"pc"})") == "`key` is missing");
  CHECK(why(R"({"do":"set","peer":"pc","key":"a.*","value":""})").find("`key` must be") == 0);
  const auto send = [&](const std::string& rest) {
    return why(R"({"do":"send","mote":"kitchen/fan","to":"pc",)" + rest + '}');
  };
  CHECK(send(R"("octets":"6d6")").find("`octets` must be octets in hexadecimal") == 0);
  CHECK(send(R"("octets":"","am_type":256)").find("`am_type` must be a whole number") == 0);
  CHECK(send(R"("octets":"","am_type":1.5)").find("`am_type` must be a whole number") == 0);
  CHECK(send(R"("octets":"","am_type":-1)").find("`am_type` must be a whole number") == 0);
  CHECK(send(R"("octets":"","reliable":1)") == "`reliable` must be true or false");
  CHECK(send(R"("octets":"","port":1)").find("`port` is not a member") == 0);
  CHECK(run.sent.empty());
  CHECK(why(std::string(line_octets_max + 1, ' ')).find("a line has at most") == 0);
  const auto nested = run.ask(std::string(100'000, '[') + std::string(100'000, ']'));
  REQUIRE(nested.size() == 1);
  CHECK(nested[0]["ok"] == false);
  CHECK(run.now == instant());
}

TEST_CASE("a batch has an answer for each of its requests", "[steering]") {
  stand_in run;
  const auto answers =
      run.ask(R"([{"do":"step","for":1},{"do":"x"},{"do":"get","peer":"pc","key":"a.b"}])");
  REQUIRE(answers.size() == 3);
  CHECK(answers[0]["now"] == 1);
  CHECK(answers[1]["ok"] == false);
  CHECK(answers[2]["value"] == "5");
}

TEST_CASE("faults happen one after the other, and can be done again", "[steering]") {
  stand_in run;
  static_cast<void>(run.ask(R"({"do":"fault","words":"kill peer pc"})"));
  static_cast<void>(run.ask(R"({"do":"fault","words":"wrong"})"));
  static_cast<void>(run.ask(R"({"do":"step","for":2})"));
  static_cast<void>(run.ask(R"({"do":"set","peer":"pc","key":"a","value":"1"})"));
  static_cast<void>(run.ask(R"({"do":"fault","words":"pause peer pc"})"));
  REQUIRE(run.faults.size() == 3);
  CHECK(run.faults[0].second == instant(duration(1)));
  CHECK(run.faults[2].second == instant(2s + duration(1)));
  CHECK(run.session.lines() == R"({"do":"fault","words":"kill peer pc"})"
                               "\n"
                               R"({"do":"step","until":2.0})"
                               "\n"
                               R"({"do":"set","peer":"pc","key":"a","value":"1"})"
                               "\n"
                               R"({"do":"fault","words":"pause peer pc"})"
                               "\n");
}

TEST_CASE("a mote's program sends, and messages are numbered as they are accepted", "[steering]") {
  stand_in run;
  const auto send = [&](const std::string& mote, const std::string& more) {
    return run.ask(R"({"do":"send","mote":")" + mote + R"(","to":"pc","octets":"6D69")" + more +
                   '}');
  };
  CHECK(send("kitchen/fan", "")["number"] == 1);
  CHECK(send("kitchen/stove", "")["why"] == "there is no such mote");
  CHECK(send("kitchen/fan", R"(,"am_type":255,"reliable":false)")["number"] == 2);
  REQUIRE(run.sent.size() == 3);
  CHECK(run.sent[0].first.octets == bytes{0x6d, 0x69});
  CHECK((run.sent[0].first.am_type == 10 && run.sent[0].first.reliable));
  CHECK((run.sent[2].first.am_type == 255 && !run.sent[2].first.reliable));
  CHECK(run.sent[2].second == 2);
  const auto lines = run.session.lines();
  CHECK(lines == R"({"do":"send","mote":"kitchen/fan","to":"pc","octets":"6d69",)"
                 R"("am_type":10,"reliable":true})"
                 "\n"
                 R"({"do":"send","mote":"kitchen/fan","to":"pc","octets":"6d69",)"
                 R"("am_type":255,"reliable":false})"
                 "\n");
}

TEST_CASE("what was done is given as tables at exact moments, and what has none as comments",
          "[steering]") {
  stand_in run;
  CHECK(run.ask(R"({"do":"fault","words":"kill peer pc"})")["at"] == "0.000000001s");
  static_cast<void>(run.ask(R"({"do":"step","until":20.12345679})"));
  static_cast<void>(run.ask(R"({"do":"set","peer":"pc","key":"a","value":"ü\n"})"));
  CHECK(run.ask(R"({"do":"fault","words":"pause peer pc"})")["at"] == "20.123456791s");
  static_cast<void>(run.ask(R"({"do":"step","until":30})"));
  static_cast<void>(run.ask(R"({"do":"set","peer":"pc","key":"a","value":""})"));
  CHECK(run.ask(R"({"do":"tables"})")["tables"] ==
        "\n[[fault]] kill peer pc at 0.000000001s\n"
        "\n# 20.12345679s: no file plans "
        R"({"do":"set","peer":"pc","key":"a","value":"\u00fc\n"})"
        "\n\n[[fault]] pause peer pc at 20.123456791s\n"
        "\n# 30s: no file plans "
        R"({"do":"set","peer":"pc","key":"a","value":""})"
        "\n");
}

TEST_CASE("writes that match a subscription come with the next step; the newest are kept",
          "[steering]") {
  stand_in run;
  static_cast<void>(run.ask(R"({"do":"tuples","owner":"pc","pattern":"a.*"})"));
  const auto write = [&](const std::string& owner, const std::string& key) {
    run.session.on_tuple({instant(1s), owner, owner, key, "5", false});
  };
  write("pc", "a.b");
  write("pc", "b.b");
  write("robot", "a.b");
  CHECK(run.ask(R"({"do":"step","for":1})")["tuples"] == json::parse(R"([[1.0,"pc","a.b","5"]])"));
  for (std::size_t i = 0; i < session::news_max + 1; ++i)
    write("pc", "a.c");
  const auto full = run.ask(R"({"do":"step","for":1})");
  CHECK(full["tuples"].size() == session::news_max);
  CHECK(full["missed"] == 1);
}

TEST_CASE("a run that is finished refuses all else", "[steering]") {
  stand_in run;
  CHECK(run.ask(R"({"do":"finish"})")["report"]["seed"] == 7);
  CHECK(run.session.is_finished());
  CHECK(run.ask(R"({"do":"events"})")["ok"] == false);
}
