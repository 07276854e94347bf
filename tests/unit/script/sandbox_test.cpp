// What a script may do, and what it gets: the same on every machine, and not without bound.
#include <set>
#include <string>
#include <string_view>

#include "script/source.hpp"
#include "support/catch.hpp"
#include "unit/script/node.hpp"

using namespace rubicon;
using script::output_of;
using script::scripted;
using script::texts;

namespace {

bool has(const std::string& text, std::string_view part) {
  INFO(text);
  return text.find(part) != std::string::npos;
}

std::string failure_of(std::string text, script::limits most = {}) {
  return scripted(std::move(text), 1, most).failure_of_start();
}

} // namespace

TEST_CASE("a script has no names that reach the machine, its memory or hidden order", "[script]") {
  for (const std::string name :
       {"io",        "os",     "debug",        "package",      "require",
        "dofile",    "load",   "loadfile",     "loadstring",   "collectgarbage",
        "coroutine", "next",   "setmetatable", "getmetatable", "rawset",
        "rawget",    "rawlen", "xpcall",       "string.dump",  "math.randomseed",
        "math.atan"}) {
    INFO(name);
    CHECK(output_of("print(" + name + ")") == texts{"nil"});
  }
  CHECK(
      output_of("local n = '' for k in pairs(_G) do n = n .. k .. ' ' end print(n)").at(0) ==
      "GATEWAY OWN_ISLAND _G _VERSION after assert cancel error every figure ipairs layer math "
      "notify pairs pcall print rawequal select settings string table tonumber tostring type utf8 "
      "warn ");
}

TEST_CASE("pairs goes through numbers, then texts, each in ascending order", "[script]") {
  CHECK(output_of(
            "local t = {b = 1, [2.5] = 2, a = 3, [-1] = 4, [3] = 5, [2] = 6, B = 7, [''] = 8}"
            " local s = '' for k, v in pairs(t) do s = s .. '[' .. k .. ']' .. v end print(s)") ==
        texts{"[-1]4[2]6[2.5]2[3]5[]8[B]7[a]3[b]1"});
  CHECK(output_of("local s = '' for k in pairs({[math.maxinteger] = 1, [1e19] = 1, [-1e300] = 1, "
                  "[math.mininteger] = 1, [-0.5] = 1}) do s = s .. k .. ' ' end print(s)") ==
        texts{"-1e+300 -9223372036854775808 -0.5 9223372036854775807 1e+19 "});
}

TEST_CASE("pairs leaves out what has been removed meanwhile", "[script]") {
  CHECK(
      output_of("local t, s = {a = 1, b = 2, c = 3}, '' for k in pairs(t) do s = s .. k t.b = nil "
                "end print(s)") == texts{"ac"});
}

TEST_CASE("pairs refuses keys without an order", "[script]") {
  CHECK(has(failure_of("for k in pairs({[true] = 1}) do end"),
            "test.lua:1: pairs: keys of type boolean have no order"));
  CHECK(has(failure_of("for k in pairs({[{}] = 1}) do end"), "keys of type table"));
}

TEST_CASE("no text of a value has an address", "[script]") {
  CHECK(output_of("print({}, print, nil, true, 1, 1.5, 'x')") ==
        texts{"table function nil true 1 1.5 x"});
  CHECK(output_of("print(tostring({}), string.format('%s %s|%5.1f', {}, print, 2))") ==
        texts{"table table function|  2.0"});
  CHECK(has(failure_of("print(string.format('%10p', {}))"), "addresses are not the same"));
  CHECK(output_of("print(0/0, -(0/0), 1/0)") == texts{"nan nan inf"});
}

TEST_CASE("math calculates by our own functions, and knows no operator for powers", "[script]") {
  CHECK(output_of("print(math.pow(2, 10), math.pow(2, -2), math.pow(9, 0.5), math.pow(-2, 3))") ==
        texts{"1024.0 0.25 3.0 -8.0"});
  CHECK(output_of("print(math.log(1), math.log(100, 10), math.exp(0), math.sin(0), math.cos(0))") ==
        texts{"0.0 2.0 1.0 0.0 1.0"});
  CHECK(output_of("print(math.log(0), math.log(-1), math.log(1/0), math.exp(-1/0))") ==
        texts{"-inf nan inf 0.0"});
  CHECK(has(failure_of("local x = 1\nprint(x ^ 2)"), "test.lua:2: the operator ^"));
  CHECK(output_of("print('^', [[ ^ ]], [==[ ]] ^ ]==], '\\'^') -- ^\n--[[ ^\n^ ]] print(1)") ==
        texts{"^  ^   ]] ^  '^", "1"});
}

TEST_CASE("sort keeps the order of equals", "[script]") {
  CHECK(
      output_of("local t = {} for i = 1, 300 do t[i] = {i % 3, i} end "
                "table.sort(t, function(a, b) return a[1] < b[1] end) "
                "local good = true for i = 2, 300 do local a, b = t[i - 1], t[i] "
                "good = good and (a[1] < b[1] or a[1] == b[1] and a[2] < b[2]) end print(good)") ==
      texts{"true"});
  for (int n = 0; n < 20; ++n) {
    INFO(n);
    CHECK(output_of("local n, t = " + std::to_string(n) +
                    ", {} for i = 1, n do t[i] = i * 7 % 19 end table.sort(t) local good = #t == n "
                    "for i = 2, n do good = good and t[i - 1] <= t[i] end print(good)") ==
          texts{"true"});
  }
  CHECK(output_of("print(table.concat(table.move({1, 2, 3, 4}, 1, 3, 2), ' '))") ==
        texts{"1 1 2 3"});
}

TEST_CASE("random numbers are those of the program's stream", "[script]") {
  random_stream rng(9);
  auto expected = std::to_string(rng.below(6) + 1);
  expected += ' ' + std::to_string(rng.below(3) + 7);
  CHECK(output_of("print(math.random(6), math.random(7, 9))", 9) == texts{expected});
  CHECK(has(failure_of("math.random(2, 1)"), "interval is empty"));
}

TEST_CASE("1000 seeds give the same results twice", "[script]") {
  const std::string text = "local t = {} for i = 1, 20 do t['k' .. math.random(1000)] = "
                           "math.normal() * math.exp(math.random()) end local s = '' "
                           "for k, v in pairs(t) do s = s .. k .. '=' .. v .. ';' end print(s)";
  std::set<std::string> different;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    scripted first(text, seed);
    scripted second(text, seed);
    const auto found = first.start();
    if (found != second.start() || first.program.figures() != second.program.figures())
      FAIL("seed " << seed);
    different.insert(found.at(0));
  }
  CHECK(different.size() == 1000);
}

TEST_CASE("a script ends above its instructions, caught or not", "[script]") {
  CHECK(has(failure_of("\nwhile true do end"),
            "test.lua:2: more than 100000 instructions in one event"));
  CHECK(has(failure_of("while true do pcall(function() while true do end end) end"),
            "more than 100000"));
  CHECK(has(failure_of("table.sort({1, 2, 3}, function() while true do end end)"),
            "more than 100000"));
  CHECK(has(failure_of("for i = 1, 300 do end", {64 * 1024, 100}), "more than 100 "));
  CHECK(failure_of("for i = 1, 40 do end", {64 * 1024, 100}).empty());
  CHECK(has(failure_of("local t = {} for i = 1, 50 do t[i] = i end "
                       "for i = 1, 1000 do for k in pairs(t) do break end end"),
            "more than 100000"));
}

TEST_CASE("a script ends above its memory, caught or not", "[script]") {
  const std::string grows = "local t = {} for i = 1, 20000 do t[i] = i end";
  CHECK(failure_of(grows, {1 << 20, 1'000'000}).empty());
  CHECK(failure_of(grows, {65536, 1'000'000}) == "more than 65536 octets of memory");
  CHECK(failure_of("pcall(pcall, function() " + grows + " end) print('goes on')",
                   {65536, 1'000'000}) == "more than 65536 octets of memory");
  CHECK(failure_of("local s = ('x'):rep(100000)") == "more than 65536 octets of memory");
  CHECK(failure_of("for i = 1, 1000 do local s = ('x'):rep(20000) .. i end").empty());
  CHECK(has(failure_of("local function f() return 1 + f() end f()", {1 << 20, 10'000'000}),
            "octets of memory"));
}

TEST_CASE("no function of a library works without bound", "[script]") {
  CHECK(output_of("print(#(''):rep(1e15))") == texts{"0"});
  CHECK(has(failure_of("table.move({}, 1, 1e15, 2, {})"), "more than 100000"));
  CHECK(has(failure_of("string.find(('a'):rep(1000), '.-.-.-b')"), "may take too long"));
  CHECK(has(failure_of("string.match(('a'):rep(60), ('a?'):rep(60))"), "may take too long"));
  CHECK(output_of("print(('temperature = 21.5'):match('^(%w+) *= *([%d.]+)$'))") ==
        texts{"temperature 21.5"});
  CHECK(output_of("print(('a.b'):find('.', 1, true), ('a-b'):gsub('[^%w]', '+'))").size() == 1);
}

TEST_CASE("errors say where and by which calls", "[script]") {
  const auto text = failure_of("local function f(x)\n  return x.y.z\nend\nfunction g()\n  "
                               "f({})\n  return 1\nend\ng()\n");
  CHECK(has(text, "test.lua:2: attempt to index a nil value (field 'y')"));
  CHECK(has(text, "test.lua:5: in "));
  CHECK(has(text, "test.lua:8: in main chunk"));
  CHECK(text.find('\n') == std::string::npos);
  CHECK(output_of("print(pcall(error, 'x', 0))") == texts{"false x"});
  CHECK(has(failure_of("error({})"), "an error without text, of type table"));
}

TEST_CASE("what is no script is refused with its line", "[script]") {
  const auto wrong = script::check({"fan.lua", "local x = 1\nlocal y = = 2\n"}, {});
  REQUIRE(wrong);
  CHECK(wrong->line == 2);
  CHECK(wrong->message == "unexpected symbol near '='");
  CHECK_FALSE(script::check({"fan.lua", "local x <const> = 1 goto out ::out::"}, {}));
  CHECK(script::check({"fan.lua", "\n\nx = 2^2"}, {})->line == 3);
  CHECK(script::check({"fan.lua", "\x1bLua"}, {}));
  CHECK(script::check({"fan.lua", "x = '" + std::string(100'000, 'x') + "'"}, {})->message ==
        "more than 65536 octets of memory");
  CHECK(script::check({"fan.lua", "x = " + std::string(1000, '(')}, {}));
}
