#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <variant>

#include "core/describe/content.hpp"
#include "core/hash.hpp"
#include "scheduler/messages/define_messages.hpp"
#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

namespace elsewhere {

/// Of the same name as another.
struct mark {
  int value = 0;
};
RUBICON_FIELDS(mark, value);

struct interface : takes<mark> {};

} // namespace elsewhere

template void rubicon::scheduler::define_messages<elsewhere::interface>();

namespace {

any_actor::behavior_type sink(actor_pointer<no_state, any_actor>) {
  return {[](mark) {}, [](const text&) {}, [](const introduction&) {}, [](stain) {}};
}

struct relay_state {
  any_actor to;
};

mark_actor::behavior_type relay(actor_pointer<relay_state, mark_actor> self, any_actor to) {
  self->state.to = std::move(to);
  return {[self](mark x) { self->delayed_send(self->state.to, 1ms, mark{x.value + 1}); }};
}

using program = std::function<void(world&)>;

/// The trace of a program in a fresh world.
std::uint64_t trace_of(const program& f) {
  world world;
  f(world);
  world.run_for(1s);
  return world.trace().hash();
}

template <class Message>
program sends(Message message) {
  return [=](world& x) { post(x.spawn("sink", sink), message); };
}

const std::uint64_t untouched = fold64().add(std::uint64_t{0}).value();

} // namespace

TEST_CASE("the same program leaves the same trace", "[scheduler][GEN-07][ACT-05]") {
  const auto f = [](world& x) {
    const auto to = x.spawn("to", sink);
    const auto from = x.spawn("from", relay, to);
    for (int i = 0; i < 10; ++i)
      post_after(from, (i % 3) * 1ms, mark{i});
  };
  CHECK(trace_of(f) == trace_of(f));
  CHECK(trace_of(f) != untouched);
}

TEST_CASE("path, content, type, number, time and order of messages all show in the trace",
          "[scheduler][GEN-07][ACT-05]") {
  const std::vector<program> programs = {
      [](world&) {},
      [](world& x) { x.spawn("sink", sink); },
      sends(mark{1}),
      sends(mark{2}),
      sends(stain{1}), // as mark{1}, but another type
      sends(text{"a", 1, {}}),
      sends(text{"b", 1, {}}),
      sends(text{"a", 2, {}}),
      sends(text{"a", 1, payload(bytes{0})}),
      sends(text{"a", 1, payload(bytes{0, 0})}),
      sends(text{"", 1, payload(bytes{'a'})}),
      sends(introduction{1, {}, 2}),
      sends(introduction{1, {}, 3}),
      [](world& x) { post(x.spawn("other", sink), mark{1}); },
      [](world& x) { post_after(x.spawn("sink", sink), 1ns, mark{1}); },
      [](world& x) {
        const auto to = x.spawn("sink", sink);
        post(to, mark{1});
        post(to, mark{2});
      },
      [](world& x) {
        const auto to = x.spawn("sink", sink);
        post(to, mark{2});
        post(to, mark{1});
      },
  };
  std::set<std::uint64_t> traces;
  for (const auto& x : programs)
    traces.insert(trace_of(x));
  CHECK(traces.size() == programs.size() - 1); // spawning alone leaves no trace
}

TEST_CASE("actor ids do not show in the trace", "[scheduler][GEN-07][ACT-05]") {
  events log;
  const auto with_ids = [&](int spawned_before) {
    return trace_of([&log, spawned_before](world& x) {
      for (int i = 0; i < spawned_before; ++i)
        x.spawn("", recorder, &log, 0); // uses up ids
      const auto who = x.spawn("", recorder, &log, 0);
      const auto to = x.spawn("sink", sink);
      post(to, introduction{1, who, 2});
      post_exit(to, caf::exit_reason::user_shutdown);
    });
  };
  CHECK(with_ids(0) == with_ids(5));
}

TEST_CASE("what the end of a world causes does not show in its trace", "[scheduler][ACT-05]") {
  world world;
  const auto child = world.spawn("", mute);
  world.run_for(1s);
  const auto parent =
      world.spawn("parent", [child](mark_pointer self) -> mark_actor::behavior_type {
        self->monitor(child);
        return {[](mark) {}};
      });
  post(parent, mark{1});
  world.run_for(1s);
  const auto hash = world.trace().hash();
  CHECK(hash != untouched);
  world.shutdown(); // the child ends first, and its monitor is notified
  CHECK(world.trace().hash() == hash);
  CHECK(world.trace().events() == 1);
}

TEST_CASE("a handle in a message arrives and leaves no mark", "[scheduler]") {
  world world;
  events log;
  const auto who = world.spawn("", recorder, &log, 0);
  using postman_pointer = actor_pointer<no_state, any_actor>;
  const auto postman = world.spawn("", [](postman_pointer self) -> any_actor::behavior_type {
    return {[self](const introduction& x) { self->send(x.who, mark{x.after}); }, [](mark) {},
            [](const text&) {}, [](stain) {}};
  });
  post(postman, introduction{1, who, 7});
  world.run_for(1s);
  CHECK(log == events{{0s, 7}});
  const auto fold_of = [](const introduction& x) {
    fold64 result;
    fold_content(result, x);
    return result.value();
  };
  CHECK(fold_of({1, who, 2}) == fold_of({1, {}, 2}));
  CHECK(fold_of({1, who, 2}) != fold_of({1, who, 3}));
}

TEST_CASE("actors that send nothing do not change the trace of others, wherever they are spawned",
          "[scheduler][GEN-07][ACT-05]") {
  const auto run = [](std::vector<std::string> order) {
    return trace_of([order](world& x) {
      any_actor to;
      for (const auto& path : order)
        if (const auto handle = x.spawn(path, sink); path == "to")
          to = handle;
      for (int i = 0; i < 5; ++i)
        post_after(to, i * 1ms, mark{i});
    });
  };
  CHECK(run({"a", "to", "b"}) == run({"to"}));
  CHECK(run({"b", "a", "to"}) == run({"to", "a", "b"}));
}

TEST_CASE("actors without path leave no trace", "[scheduler]") {
  CHECK(trace_of([](world& x) { post(x.spawn("", sink), mark{1}); }) == untouched);
}

TEST_CASE("a world without trace still places its actors", "[scheduler]") {
  world world({.trace = false});
  const auto to = world.spawn("some/where", sink);
  post(to, mark{1});
  world.run_for(1s);
  CHECK(world.trace().hash() == untouched);
  CHECK(world.trace().events() == 0);
  CHECK(to.get().path() == "some/where");
}

TEST_CASE("an actor spawned by a handler is traced from its first message", "[scheduler][GEN-07]") {
  world world;
  std::vector<std::string> seen;
  world.trace().observe([&](const delivery& x) {
    seen.push_back(to_text(x.time) + ' ' + std::string(x.sender) + '>' + std::string(x.path) + ' ' +
                   x.message.text());
  });
  const auto parent = world.spawn("parent", [](mark_pointer self) -> mark_actor::behavior_type {
    return {[self](mark x) {
      const auto child = spawn_at(self, "child/" + std::to_string(x.value), sink);
      self->send(child, mark{x.value + 1});
      self->delayed_send(child, 1ms, text{"five", 5, {}});
    }};
  });
  post(parent, mark{1});
  world.run_for(1s);
  CHECK(seen == std::vector<std::string>{"0.000000 >parent mark(value=1)",
                                         "0.000000 parent>child/1 mark(value=2)",
                                         "0.001000 parent>child/1 "
                                         "text(words=\"five\", number=5, octets=)"});
  CHECK(world.trace().events() == 3);
}

TEST_CASE("a watcher sees what its kind of actors is delivered, and changes no trace",
          "[scheduler][ACT-05]") {
  const auto run = [](bool watched) {
    world world;
    std::vector<std::string> seen;
    if (watched)
      world.trace().watch("peer/", [&](const delivery& x) {
        const auto* found = x.as<mark>();
        seen.push_back(std::string(x.path) + ' ' +
                       (found != nullptr ? std::to_string(found->value) : "another"));
      });
    const auto peer = world.spawn("peer/a", sink);
    const auto mote = world.spawn("mote/a", sink);
    post(peer, mark{1});
    post(mote, mark{2});
    post(peer, stain{3});
    post(peer, text{"five", 5, {}});
    world.run_for(1s);
    if (watched)
      CHECK(seen == std::vector<std::string>{"peer/a 1", "peer/a another", "peer/a another"});
    return world.trace().hash();
  };
  CHECK(run(true) == run(false));
}

TEST_CASE("a delivery has what its sender was handling, and whether it is received",
          "[scheduler]") {
  world world;
  std::vector<std::vector<std::uint64_t>> seen; // number, cause, received
  world.trace().observe([&](const delivery& x) {
    seen.push_back({x.number, x.cause, x.received ? 1U : 0U});
  });
  world.trace().observe_remarks([](const remark&) {});
  const auto to = world.spawn("to", sink);
  const auto relay = world.spawn("relay", [to](mark_pointer self) -> mark_actor::behavior_type {
    return {[self, to](mark x) {
      self->send(to, x);
      self->delayed_send(to, 1ms, x); // by the clock, which keeps where it came from
    }};
  });
  post(relay, mark{1});
  post(relay, mark{2});
  world.run_for(1s);
  CHECK(seen == std::vector<std::vector<std::uint64_t>>{
                    {1, 0, 1}, {2, 0, 1}, {3, 1, 1}, {4, 2, 1}, {5, 1, 1}, {6, 2, 1}});
  post_exit(to, caf::exit_reason::kill);
  world.run_for(1s);
  seen.clear();
  post(to, mark{3});
  CHECK(seen == std::vector<std::vector<std::uint64_t>>{{8, 0, 0}});
}

TEST_CASE("a remark reaches observers and leaves the trace alone", "[scheduler][ACT-05]") {
  const auto run = [](bool observed) {
    world world;
    std::vector<std::string> seen;
    int made = 0;
    if (observed)
      world.trace().observe_remarks([&](const remark& x) {
        seen.push_back(to_text(x.time) + ' ' + std::string(x.path) + ' ' + std::string(x.what) +
                       ' ' + std::to_string(x.id) + ' ' + to_hex(x.octets));
      });
    const auto speaker =
        world.spawn("speaker", [&](mark_pointer self) -> mark_actor::behavior_type {
          return {[self, &made](mark x) {
            self->remark("heard", static_cast<std::uint64_t>(x.value), [&made] {
              ++made;
              return bytes{0xca, 0xfe};
            });
          }};
        });
    post(speaker, mark{7});
    world.run_for(1s);
    CHECK(made == (observed ? 1 : 0));
    CHECK(seen == (observed ? std::vector<std::string>{"0.000000 speaker heard 7 cafe"}
                            : std::vector<std::string>{}));
    return world.trace().hash();
  };
  CHECK(run(true) == run(false));
}

TEST_CASE("every kind of value is folded, each in its own form", "[scheduler][ACT-05]") {
  const auto fold = [](auto... x) {
    fold64 result;
    (fold_content(result, x), ...);
    return result.value();
  };
  const std::set<std::uint64_t> all = {
      fold(std::int8_t{1}),
      fold(std::uint16_t{2}),
      fold(std::int32_t{-1}),
      fold(std::uint32_t{0xffffffff}),
      fold(std::byte{9}),
      fold(1.0F),
      fold(1.0),
      fold(-1.0),
      fold(std::string("abc")),
      fold(std::string("abd")),
      fold(std::string("abc"), std::string()),
      fold(std::string(), std::string("abc")),
      fold(std::string("12345678")),
      fold(std::string("123456789")),
      fold(std::vector<int>{1, 2}),
      fold(std::vector<int>{1}, std::vector<int>{2}),
      fold(bytes{1, 2}),
      fold(payload(bytes{1, 2, 3})),
      fold(std::map<int, int>{{1, 2}}),
      fold(duration(77)),
      fold(instant(78ns)),
      fold(std::optional<int>()),
      fold(std::optional<int>(3)),
      fold(std::variant<int, bool>(5)),
      fold(std::variant<bool, int>(5)),
      fold(text{"a", 1, {}}),
      fold(mark_actor()),
  };
  CHECK(all.size() == 27);
}

TEST_CASE("the fold of known content is known, on every machine", "[scheduler][ACT-05]") {
  // Worked out by hand from what fold_content and fold64 state.
  fold64 result;
  fold_content(result, text{"12345678abc", 1.0, payload(bytes{0xca, 0xfe})});
  fold_content(result, mark{-2});
  fold64 expected;
  expected.add(11).add(0x3837363534333231).add(0x636261);
  expected.add(0x3ff0000000000000).add(2).add(0xfeca).add(static_cast<std::uint64_t>(-2));
  CHECK(result.value() == expected.value());
}

TEST_CASE("a trace is worked out from path, time, name of the type and content",
          "[scheduler][ACT-05]") {
  const auto path = fold64().add(std::string_view("sink")).value();
  const auto first = fold64(path)
                         .add(std::uint64_t{0})
                         .add(fold64().add(std::string_view("mark")).value())
                         .add(std::uint64_t{5});
  const auto second = fold64(first)
                          .add(std::uint64_t{3000})
                          .add(fold64().add(std::string_view("stain")).value())
                          .add(std::uint64_t{6});
  CHECK(trace_of([](world& x) {
          const auto to = x.spawn("sink", sink);
          post(to, mark{5});
          post_after(to, 3us, stain{6});
        }) == fold64().add(second.value() - path).value());
}

TEST_CASE("the order in which types of messages are numbered does not show in the trace",
          "[scheduler][GEN-07][ACT-05]") {
  const auto trace = [](auto message) {
    trace_part part;
    std::uint64_t so_far = 1;
    part.fold(so_far, instant(1s), *make_envelope(message));
    return std::pair(part.sum(), so_far);
  };
  CHECK(type_of<mark>::value.index() != type_of<elsewhere::mark>::value.index());
  CHECK(trace(mark{3}) == trace(elsewhere::mark{3}));
  CHECK(trace(mark{3}) != trace(elsewhere::mark{4}));
  CHECK(trace(mark{3}) != trace(stain{3}));
}

TEST_CASE("a message to an actor that has ended is counted and not handled",
          "[scheduler][ACT-05]") {
  world world;
  events log;
  std::vector<bool> received;
  world.trace().observe([&](const delivery& x) { received.push_back(x.received); });
  const auto to = world.spawn("to", recorder, &log, 0);
  post(to, mark{1});
  post_exit(to, caf::exit_reason::user_shutdown);
  post(to, mark{2}); // it still lives when this comes
  world.run_for(1s);
  const auto hash = world.trace().hash();
  post(to, mark{3});
  world.run_for(1s);
  CHECK(log == events{{0s, 1}});
  CHECK(received == std::vector{true, true, true, false});
  CHECK(world.trace().events() == 4);
  CHECK(world.trace().hash() != hash);
}
