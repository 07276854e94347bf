// Appending to tuples, at owners and subscribers, over links that lose and reorder (TUP-07).
#include <map>

#include "peis/wire/package.hpp"
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis {
namespace {

using test::robot;
using test::start;
using test::world;

prototype log_of(peer_id owner) {
  return prototype_of(owner, *key::parse("log"));
}

struct pair_with_log {
  world w{7};
  peer_id a = w.add(1);
  peer_id b = w.add(2);
  link_id link = w.connect(a, b);

  pair_with_log() {
    w.run_for(1s);
    w.perform(b, w.at(b).subscriptions().subscribe(log_of(a), subscription_id{1}, w.now()));
    w.run_for(100ms);
  }
  void set(std::string_view text) {
    w.perform(a, w.at(a).tuples().set("log", text_content(text), w.now()));
  }
  void append(peer_id who, std::string_view text, request_id request = no_request) {
    w.perform(who, w.at(who).tuples().append(log_of(a), to_bytes(text), w.now(), request));
  }
  [[nodiscard]] std::string held(peer_id who) {
    const auto x = w.at(who).reader().find(a, "log");
    return x ? std::string(x->text()) : "none";
  }
  [[nodiscard]] std::size_t sent(std::uint16_t port) const {
    std::size_t count = 0;
    for (const auto& x : w.packages)
      count += x.header.port == port ? 1 : 0;
    return count;
  }
};

} // namespace

TEST_CASE("appends of owner and writer reach everybody in one order", "[peis][TUP-07]") {
  pair_with_log p;
  const auto c = p.w.add(3);
  p.w.connect(c, p.b);
  p.w.perform(c,
              p.w.at(c).subscriptions().subscribe(log_of(any_peer), subscription_id{1}, p.w.now()));
  p.w.run_for(3s);
  p.set("0");
  for (int i = 1; i < 6; ++i) {
    p.append(p.a, "a" + std::to_string(i));
    p.append(c, "c" + std::to_string(i), request_id{static_cast<std::uint64_t>(i)});
    p.w.run_for(3ms);
  }
  p.w.run_for(2s);
  const auto whole = p.held(p.a);
  CHECK(whole.size() == 21);
  for (int i = 1; i < 6; ++i) {
    CHECK(whole.find("a" + std::to_string(i)) != std::string::npos);
    CHECK(whole.find("c" + std::to_string(i)) != std::string::npos);
  }
  CHECK(p.held(p.b) == whole);
  CHECK(p.held(c) == whole);
  CHECK(p.w.all<outcome>(c).size() == 5);
  CHECK(p.sent(port::append_notice) > 0);
}

TEST_CASE("an append to what does not exist or is reserved has no effect", "[peis][TUP-07]") {
  pair_with_log p;
  p.append(p.a, "x", request_id{1});
  p.append(p.b, "x", request_id{2});
  const auto name = std::string(p.w.at(p.a).reader().find(p.a, "kernel.name")->text());
  p.w.perform(p.b, p.w.at(p.b).tuples().append(prototype_of(p.a, *key::parse("kernel.*")),
                                               to_bytes("x"), p.w.now(), request_id{3}));
  CHECK(p.w.all<outcome>(p.b).back().why == cause::refused); // at once
  p.w.perform(p.b, p.w.at(p.b).tuples().append(prototype_of(p.a, *key::parse("*.name")),
                                               to_bytes("x"), p.w.now()));
  p.w.run_for(1s);
  CHECK(p.held(p.a) == "none");
  CHECK(p.w.all<outcome>(p.a).at(0).success);
  CHECK(p.w.all<outcome>(p.b).back().success);
  CHECK(p.w.at(p.a).reader().find(p.a, "kernel.name")->text() == name);
  CHECK(p.w.at(p.a).counters().tuples.refused > 0);
}

TEST_CASE("an append for any owner reaches all that hold a match", "[peis][TUP-07]") {
  pair_with_log p;
  p.set("a");
  p.w.perform(p.b, p.w.at(p.b).tuples().set("log", text_content("b"), p.w.now()));
  p.w.perform(p.b, p.w.at(p.b).tuples().append(log_of(any_peer), to_bytes("+"), p.w.now()));
  p.w.run_for(1s);
  CHECK(p.held(p.a) == "a+");
  CHECK(p.w.at(p.b).reader().find(p.b, "log")->text() == "b+");
}

TEST_CASE("prototypes narrow what is appended to; a MIME type cannot travel",
          "[peis][TUP-07][TUP-24]") {
  pair_with_log p;
  p.set("a");
  auto wanted = log_of(p.a);
  wanted.mimetype = "text/html";
  p.w.perform(p.a, p.w.at(p.a).tuples().append(wanted, to_bytes("+"), p.w.now()));
  CHECK(p.held(p.a) == "a");
  const auto refused = p.w.at(p.b).tuples().append(wanted, to_bytes("+"), p.w.now(), request_id{1});
  CHECK(std::get<outcome>(refused.at(0)).why == cause::bad_value);
  wanted.mimetype.reset();
  wanted.value = text_content("A").value;
  p.w.perform(p.b, p.w.at(p.b).tuples().append(wanted, to_bytes("+"), p.w.now()));
  p.w.run_for(100ms);
  CHECK(p.held(p.a) == "a+");
  p.w.perform(p.b, p.w.at(p.b).tuples().append(wanted, to_bytes("+"), p.w.now()));
  p.w.run_for(100ms);
  CHECK(p.held(p.a) == "a+");
}

TEST_CASE("text keeps one trailing NUL, octets are joined as they are", "[peis][TUP-07]") {
  pair_with_log p;
  p.set("a");
  p.append(p.a, "b");
  p.w.perform(p.a, p.w.at(p.a).tuples().append(log_of(p.a), text_content("c").value, p.w.now()));
  CHECK(to_hex(p.w.at(p.a).reader().find(p.a, "log")->value.view()) == "61626300");
  p.w.perform(p.a, p.w.at(p.a).tuples().set("log", binary_content({}), p.w.now()));
  for (const std::uint8_t octet : bytes{7, 0, 9})
    p.w.perform(p.a, p.w.at(p.a).tuples().append(log_of(p.a), bytes{octet}, p.w.now()));
  p.w.run_for(1s);
  const auto x = p.w.at(p.b).reader().find(p.a, "log");
  REQUIRE(x);
  CHECK(to_hex(x->value.view()) == "070009");
  CHECK(x->mimetype == binary_mimetype); // not that of an empty value any more
}

TEST_CASE("the next notice leaves after the one before is acknowledged", "[peis][TUP-07]") {
  pair_with_log p;
  p.set("0");
  p.append(p.a, "1"); // as a whole value
  p.w.run_for(1s);
  p.w.keep = [](const package_header& x) { return x.port != port::acknowledgements; };
  p.w.packages.clear();
  for (const auto* text : {"2", "3", "4"})
    p.append(p.a, text);
  p.w.run_for(300ms);
  CHECK(p.sent(port::append_notice) == 1);
  p.w.keep = nullptr;
  p.w.run_for(2s);
  CHECK(p.sent(port::append_notice) >= 3);
  CHECK(p.held(p.b) == "01234");
}

TEST_CASE("appends over a lossy link end in the same value", "[peis][TUP-07][TUP-17]") {
  pair_with_log p;
  random_stream rng(3, "loss");
  p.w.keep = [&](const package_header&) { return rng.below(100) >= 30; };
  p.set("begin ");
  for (int i = 0; i < 60; ++i) {
    p.append(i % 3 == 0 ? p.b : p.a, std::to_string(i) + ' ');
    if (i == 30)
      p.set("anew ");
    p.w.run_for(200ms);
  }
  p.w.run_for(60s);
  p.w.keep = nullptr;
  p.w.run_for(40s);
  CHECK(p.held(p.a).size() > 50);
  CHECK(p.held(p.b) == p.held(p.a));
}

TEST_CASE("too many waiting notices become one push of the whole value", "[peis][TUP-07]") {
  pair_with_log p;
  p.set("0");
  p.append(p.a, "1");
  p.w.run_for(1s);
  p.w.keep = [](const package_header& x) { return x.port != port::append_notice; };
  for (int i = 0; i < 100; ++i)
    p.append(p.a, "x");
  CHECK(p.w.at(p.a).counters().tuples.appends_collapsed > 0);
  p.w.keep = nullptr;
  p.w.run_for(5s);
  CHECK(p.held(p.b) == p.held(p.a));
  CHECK(p.held(p.b).size() == 102);
}

TEST_CASE("a notice that is never delivered is made up for", "[peis][TUP-07]") {
  pair_with_log p;
  p.set("0");
  p.append(p.a, "1");
  p.w.run_for(1s);
  p.w.keep = [](const package_header& x) { return x.port != port::append_notice; };
  p.append(p.a, "2");
  p.append(p.a, "3");
  p.w.run_for(20s);
  CHECK(p.held(p.b) == "0123");
}

TEST_CASE("who subscribes between appends gets all of them once", "[peis][TUP-07][TUP-08]") {
  pair_with_log p;
  p.set("0");
  p.append(p.a, "1");
  p.append(p.a, "2");
  p.w.perform(p.b, p.w.at(p.b).subscriptions().subscribe(prototype_of(any_peer, *key::parse("*")),
                                                         subscription_id{2}, p.w.now()));
  p.w.run_for(2ms);
  p.append(p.a, "3");
  p.append(p.a, "4");
  p.w.run_for(5s);
  CHECK(p.held(p.b) == "01234");
}

TEST_CASE("who asked for a certain value is not notified of appends it may not hold",
          "[peis][TUP-07]") {
  pair_with_log p;
  const auto c = p.w.add(3);
  p.w.connect(c, p.a);
  auto wanted = log_of(p.a);
  wanted.value = text_content("012").value;
  p.w.perform(c, p.w.at(c).subscriptions().subscribe(wanted, subscription_id{1}, p.w.now()));
  p.w.run_for(3s);
  p.set("0");
  for (const auto* text : {"1", "2", "3"}) {
    p.append(p.a, text);
    p.w.run_for(500ms);
  }
  CHECK(p.held(p.b) == "0123");
  CHECK(p.held(c) == "012");
  CHECK(p.sent(port::append_notice) == 0);
}

} // namespace rubicon::peis
