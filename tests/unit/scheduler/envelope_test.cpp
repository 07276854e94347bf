// Messages as such: what is known of them, where their memory comes from, and who drops them.
#include <memory>
#include <utility>

#include "scheduler/messages/define_messages.hpp"
#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

namespace {

/// Counts how many of its like there are.
struct token {
  std::shared_ptr<int> held;

  void fold_into(fold64&) const {}
  void print_to(std::string& out) const { out += "token"; }
};

struct parcel {
  token what;
};
RUBICON_FIELDS(parcel, what);

struct parcel_interface : extends<mark_interface, parcel> {};
using parcel_actor = ref<parcel_interface>;
using parcel_pointer = actor_pointer<counted_state, parcel_actor>;

/// Drops parcels and, at a mark, quits.
parcel_actor::behavior_type receiver(parcel_pointer self) {
  return {[](const parcel&) {}, [self](mark) { self->quit(); }};
}

/// While this lives, its pool is the one of this thread.
struct pool_in_use {
  explicit pool_in_use(envelope_pool* x) : before(std::exchange(envelope_pool::current, x)) {}
  ~pool_in_use() { envelope_pool::current = before; }
  pool_in_use(const pool_in_use&) = delete;
  pool_in_use& operator=(const pool_in_use&) = delete;

  envelope_pool* before;
};

static_assert(accepts<any_interface, mark> && accepts<any_interface, const text&>);
static_assert(!accepts<mark_interface, stain>);
static_assert(covers<any_interface, mark_interface> && !covers<mark_interface, any_interface>);
static_assert(std::is_convertible_v<any_actor, mark_actor>);
static_assert(!std::is_convertible_v<mark_actor, any_actor>);

} // namespace

template void rubicon::scheduler::define_messages<parcel_interface>();

TEST_CASE("a message finds its handler, whatever the order of handlers", "[scheduler]") {
  using any_pointer = actor_pointer<no_state, any_actor>;
  world world;
  std::vector<std::string> seen;
  const auto on_mark = [&](mark) { seen.emplace_back("mark"); };
  const auto on_text = [&](const text&) { seen.emplace_back("text"); };
  const auto on_introduction = [&](introduction&) { seen.emplace_back("introduction"); };
  const auto on_stain = [&](stain) { seen.emplace_back("stain"); };
  const std::vector<any_actor> all{
      world.spawn("",
                  [&](any_pointer) -> any_actor::behavior_type {
                    return {on_mark, on_text, on_introduction, on_stain};
                  }),
      world.spawn("",
                  [&](any_pointer) -> any_actor::behavior_type {
                    return {on_stain, on_introduction, on_text, on_mark};
                  }),
      world.spawn("", [&](any_pointer) -> any_actor::behavior_type {
        return {on_introduction, on_mark, on_stain, on_text};
      })};
  for (const auto& to : all) {
    seen.clear();
    post(to, text{});
    post(to, mark{});
    post(to, stain{});
    post(to, introduction{});
    world.run_for(0s);
    CHECK(seen == std::vector<std::string>{"text", "mark", "stain", "introduction"});
  }
}

TEST_CASE("a handle stands for all that takes the same messages and more", "[scheduler]") {
  world world;
  std::vector<int> seen;
  using any_pointer = actor_pointer<no_state, any_actor>;
  const auto made = world.spawn("", [&](any_pointer self) -> any_actor::behavior_type {
    self->send(self->handle<mark_interface>(), mark{1});
    return {[&](mark x) { seen.push_back(x.value); }, [](const text&) {},
            [](const introduction&) {}, [](stain) {}};
  });
  const mark_actor part = made;
  post(part, mark{2});
  world.run_for(0s);
  CHECK(seen == std::vector{2, 1});
  CHECK(part.id() == made.id());
  CHECK(part.address() == made.address());
}

TEST_CASE("what is sent to no actor is dropped", "[scheduler]") {
  world world;
  const mark_actor no_actor;
  const auto sender = world.spawn("", [no_actor](mark_pointer self) -> mark_actor::behavior_type {
    self->send(no_actor, mark{});
    self->delayed_send(no_actor, 1s, mark{});
    self->scheduled_send(no_actor, instant(1s), mark{});
    return {[](mark) {}};
  });
  post(no_actor, mark{});
  post_after(no_actor, 1s, mark{});
  post_at(no_actor, instant(1s), mark{});
  post_exit(no_actor, caf::exit_reason::kill);
  world.run_for(2s);
  CHECK(world.stats().timeouts == 0);
  CHECK(!no_actor);
  CHECK(no_actor == nullptr);
  CHECK(no_actor.id() == 0);
}

TEST_CASE("an actor knows who has sent what it handles", "[scheduler]") {
  world world;
  std::vector<caf::actor_id> senders;
  const auto to = world.spawn("", [&](mark_pointer self) -> mark_actor::behavior_type {
    CHECK(self->sender() == 0);
    return {[&, self](mark) { senders.push_back(self->sender()); }};
  });
  const auto from = world.spawn("", [to](mark_pointer self) -> mark_actor::behavior_type {
    self->send(to, mark{});
    self->delayed_send(to, 1ms, mark{});
    return {[](mark) {}};
  });
  post_after(to, 2ms, mark{});
  world.run_for(1s);
  CHECK(senders == std::vector<caf::actor_id>{from.id(), from.id(), 0});
}

TEST_CASE("a message shows its name and its fields", "[scheduler]") {
  CHECK(make_envelope(mark{3})->text() == "mark(value=3)");
  CHECK(make_envelope(introduction{1, {}, 2})->text() ==
        "introduction(value=1, who=nobody, after=2)");
  CHECK(make_envelope(text{"a \"b\"", 1.5, payload(bytes{0xca, 0xfe})})->type().name() == "text");
  const auto x = make_envelope(mark{3});
  REQUIRE(x->as<mark>() != nullptr);
  CHECK(x->as<mark>()->value == 3);
  CHECK(x->as<stain>() == nullptr);
  CHECK(type_of<mark>::value.name_hash() == fold64().add(std::string_view("mark")).value());
  CHECK(type_of<mark>::value.index() < message_type::count());
}

TEST_CASE("a copy of a message is the same, and another", "[scheduler]") {
  const auto held = std::make_shared<int>(0);
  auto x = make_envelope(parcel{{held}});
  x->sender = 7;
  CHECK(held.use_count() == 2);
  auto y = x->type().copy(*x);
  CHECK(held.use_count() == 3);
  CHECK(&y->type() == &x->type());
  CHECK(y->text() == x->text());
  CHECK(y->as<parcel>()->what.held == held);
  CHECK(y->sender == 0); // it is not sent yet
  CHECK(y->next == nullptr);
  x.reset();
  CHECK(held.use_count() == 2);
  y.reset();
  CHECK(held.use_count() == 1);
}

TEST_CASE("the size of a message is that of its values", "[scheduler]") {
  const auto size_of = [](auto x) {
    const auto made = make_envelope(std::move(x));
    return made->type().measure(*made);
  };
  CHECK(size_of(mark{1}) == 4);
  CHECK(size_of(text{"abc", 1, payload(bytes{1, 2})}) == 3 + 8 + 2);
  CHECK(size_of(text{}) == 8);
  CHECK(size_of(introduction{}) == 4 + 4); // a handle has no length of its own
}

TEST_CASE("what CAF sends shows its text, has no size and cannot be copied", "[scheduler]") {
  world world;
  int seen = 0;
  world.trace().observe([&](const delivery& x) {
    ++seen;
    CHECK(x.message.type().name() == "system_message");
    CHECK(x.message.text().find("exit_msg") != std::string::npos);
    CHECK(x.message.type().measure(x.message) == 0);
    CHECK(x.message.type().copy == nullptr);
    CHECK(x.as<mark>() == nullptr);
  });
  post_exit(world.spawn("a", mute), caf::exit_reason::user_shutdown);
  CHECK(seen == 1);
}

TEST_CASE("a mailbox is first in, first out, and owns what is in it", "[scheduler]") {
  const auto held = std::make_shared<int>(0);
  {
    mailbox box;
    CHECK(box.empty());
    for (int round = 0; round < 2; ++round) { // it can be filled again
      for (int i = 0; i < 3; ++i)
        box.push(make_envelope(mark{i}));
      for (int i = 0; i < 3; ++i) {
        const auto x = box.pop();
        CHECK(x->as<mark>()->value == i);
        CHECK(x->next == nullptr);
      }
      CHECK(box.empty());
    }
    for (int i = 0; i < 3; ++i)
      box.push(make_envelope(parcel{{held}}));
    box.clear();
    CHECK(box.empty());
    CHECK(held.use_count() == 1);
    box.push(make_envelope(parcel{{held}}));
    CHECK(held.use_count() == 2);
  }
  CHECK(held.use_count() == 1);
}

TEST_CASE("a mailbox drops its messages when its actor ends, even while there are handles",
          "[scheduler][ACT-12]") {
  world world;
  const auto held = std::make_shared<int>(0);
  const auto to = world.spawn("", receiver);
  const auto fill = [&] {
    for (int i = 0; i < 10; ++i)
      post(to, parcel{{held}});
  };
  SECTION("because it quits") {
    post(to, mark{});
    fill();
    CHECK(held.use_count() == 11);
    world.run_for(0s);
  }
  SECTION("because it is killed") {
    world.run_for(0s);
    fill();
    CHECK(held.use_count() == 11);
    world.scheduler().kill_all();
  }
  SECTION("because it is killed before it begins") {
    fill();
    world.scheduler().kill_all();
  }
  CHECK(to.get().has_ended());
  CHECK(held.use_count() == 1);
  CHECK(counted_state::alive == 0);
  fill(); // is dropped at once
  CHECK(held.use_count() == 1);
}

TEST_CASE("what a state sends its actor as it ends is dropped with the rest", "[scheduler]") {
  struct last_words {
    ~last_words() {
      if (to)
        post(to, parcel{{held}});
    }
    parcel_actor to;
    std::shared_ptr<int> held;
  };
  world world;
  const auto held = std::make_shared<int>(0);
  using dying_pointer = actor_pointer<last_words, parcel_actor>;
  const auto to = world.spawn("", [&](dying_pointer self) -> parcel_actor::behavior_type {
    self->state.to = self->handle();
    self->state.held = held;
    return {[](const parcel&) { FAIL("it has ended"); }, [self](mark) { self->quit(); }};
  });
  post(to, mark{});
  world.run_for(1s);
  CHECK(to.get().has_ended());
  CHECK(held.use_count() == 1);
}

TEST_CASE("what an actor is to begin with is freed when it begins, or is killed before",
          "[scheduler][ACT-12]") {
  const bool begins = GENERATE(false, true);
  world world;
  const auto held = std::make_shared<int>(0);
  const auto to = world.spawn(
      "",
      [](counted_pointer, const std::shared_ptr<int>&) -> mark_actor::behavior_type {
        return {[](mark) {}};
      },
      held);
  CHECK(held.use_count() == 2);
  if (begins)
    world.run_for(0s);
  else
    world.scheduler().kill_all();
  CHECK(held.use_count() == 1);
}

TEST_CASE("a pool hands out again what it was given, by size", "[scheduler]") {
  envelope_pool pool;
  const pool_in_use here(&pool);
  auto* const small = envelope_pool::take(64);
  auto* const large = envelope_pool::take(65);
  envelope_pool::give(small, 64);
  envelope_pool::give(large, 65);
  CHECK(envelope_pool::take(96) == large);
  CHECK(envelope_pool::take(33) == small);
  auto* const another = envelope_pool::take(33); // none is left
  CHECK(another != small);
  for (auto* each : {small, another})
    envelope_pool::give(each, 33);
  envelope_pool::give(large, 96);
}

TEST_CASE("a pool keeps 256 blocks of a size and no more", "[scheduler]") {
  constexpr std::size_t kept = 256;
  envelope_pool pool;
  const pool_in_use here(&pool);
  std::vector<void*> blocks;
  for (std::size_t i = 0; i <= kept; ++i)
    blocks.push_back(envelope_pool::take(40));
  for (auto* each : blocks)
    envelope_pool::give(each, 40);
  std::vector<void*> again;
  for (std::size_t i = 0; i < kept; ++i) // the last it was given went back to the system
    again.push_back(envelope_pool::take(40));
  CHECK(std::vector<void*>(again.rbegin(), again.rend()) ==
        std::vector<void*>(blocks.begin(), blocks.end() - 1));
  for (auto* each : again)
    envelope_pool::give(each, 40);
}

TEST_CASE("a pool takes blocks of another pool and of none", "[scheduler]") {
  void* of_one = nullptr;
  void* of_none = nullptr;
  {
    const pool_in_use no_pool(nullptr);
    of_none = envelope_pool::take(40);
    envelope_pool::give(envelope_pool::take(40), 40);
  }
  envelope_pool two;
  {
    envelope_pool one;
    const pool_in_use here(&one);
    of_one = envelope_pool::take(40);
    envelope_pool::give(envelope_pool::take(40), 40);
  } // ends with a block in it
  const pool_in_use here(&two);
  envelope_pool::give(of_one, 40);
  envelope_pool::give(of_none, 40);
  CHECK(envelope_pool::take(40) == of_none);
  CHECK(envelope_pool::take(40) == of_one);
  const pool_in_use no_pool(nullptr);
  envelope_pool::give(of_one, 40);
  envelope_pool::give(of_none, 40);
}

TEST_CASE("large messages are the system's, and arrive like others", "[scheduler]") {
  envelope_pool pool;
  const pool_in_use here(&pool);
  auto* const block = envelope_pool::take(257);
  envelope_pool::give(block, 257);
  auto* const kept = envelope_pool::take(256);
  envelope_pool::give(kept, 256);
  CHECK(envelope_pool::take(256) == kept);
  envelope_pool::give(kept, 256);
}

TEST_CASE("each process has a pool of its own, in use while it is executed", "[scheduler]") {
  world world;
  auto& other = world.scheduler().add_process();
  std::vector<envelope_pool*> pools;
  const auto place_in = [&](process& where) {
    const auto made =
        make_at(world.system(), where, "", [&](mark_pointer) -> mark_actor::behavior_type {
          return {[&](mark) { pools.push_back(envelope_pool::current); }};
        });
    made.get().launch(nullptr, false, false);
    post(made, mark{});
    return made;
  };
  const auto one = place_in(world.scheduler().supervisor());
  const auto two = place_in(other);
  world.run_for(1s);
  REQUIRE(pools.size() == 2);
  CHECK(pools[0] != nullptr);
  CHECK(pools[1] != nullptr);
  CHECK(pools[0] != pools[1]);
  CHECK(envelope_pool::current == nullptr);
}
