#include <array>
#include <memory>
#include <optional>

#include <boost/asio/buffer.hpp>
#include <boost/asio/local/connect_pair.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read.hpp>

#include "io/context.hpp"
#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

// Leaks and what is used after its end show under the address sanitizer.

namespace {

mark_actor::behavior_type keeping(counted_pointer self, mark_actor other) {
  self->state.friend_of_mine = std::move(other);
  return {[](mark) {}};
}

} // namespace

TEST_CASE("a world ends with timers pending, periodic ones too", "[scheduler][ACT-11]") {
  {
    world world;
    for (int i = 0; i < 3; ++i)
      world.spawn("", [](counted_pointer self) -> mark_actor::behavior_type {
        self->delayed_send(self, 1ms, mark{});
        self->delayed_send(self, 60min, mark{});
        return {[self](mark) { self->delayed_send(self, 1ms, mark{}); }};
      });
    world.run_for(10ms);
    CHECK(counted_state::alive == 3);
  }
  CHECK(counted_state::alive == 0);
}

TEST_CASE("a world ends with actors that hold each other and that only messages hold",
          "[scheduler][ACT-11]") {
  {
    world world;
    auto one = world.spawn("", keeping, mark_actor());
    auto two = world.spawn("", keeping, one);
    post_exit(one, caf::exit_reason::normal);
    one = world.spawn("", [two](counted_pointer self) -> mark_actor::behavior_type {
      self->state.friend_of_mine = two;
      return {[](mark) {}};
    });
    post_after(world.spawn("", keeping, one), 1h, mark{});
    post(world.spawn("", keeping, one), mark{}); // never had a turn
    world.run_for(0s);
    post(world.spawn("", keeping, two), mark{}); // never had a turn
    CHECK(counted_state::alive == 5);
  }
  CHECK(counted_state::alive == 0);
}

TEST_CASE("a world ends with actors that keep each other busy", "[scheduler][ACT-11]") {
  {
    world world;
    world.spawn("", [](counted_pointer self) -> mark_actor::behavior_type {
      self->send(self, mark{});
      return {[self](mark) { self->send(self, mark{}); }};
    });
    CHECK(!world.drain(100));
  }
  CHECK(counted_state::alive == 0);
}

TEST_CASE("a world ends although a supervisor would restart what dies", "[scheduler][ACT-11]") {
  {
    world world;
    const auto boss = world.spawn("", [](counted_pointer self) -> mark_actor::behavior_type {
      self->set_exit_handler([](const caf::exit_msg&) {});
      self->set_down_handler([=](const caf::down_msg&) { spawn_at<monitored>(self, "", mute); });
      self->state.friend_of_mine = spawn_at<monitored>(self, "", mute);
      return {[](mark) {}};
    });
    world.run_for(1s);
    CHECK(counted_state::alive == 2);
  }
  CHECK(counted_state::alive == 0);
}

TEST_CASE("a world ends with open sockets in its loop", "[scheduler][ACT-11]") {
  using protocol = boost::asio::local::stream_protocol;
  struct connection {
    explicit connection(boost::asio::io_context& x) : socket(x) {}
    protocol::socket socket;
    std::array<char, 16> octets{};
  };
  {
    world world;
    const auto owner = world.spawn("", mute);
    auto& context = io::context_of(world.loop());
    const auto here = std::make_shared<connection>(context);
    const auto there = std::make_shared<connection>(context);
    boost::asio::local::connect_pair(here->socket, there->socket);
    boost::asio::async_read(
        here->socket, boost::asio::buffer(here->octets),
        [here, there, owner](const auto&, std::size_t) { post(owner, mark{}); });
    world.run_for(1s);
    CHECK(counted_state::alive == 1);
  }
  CHECK(counted_state::alive == 0);
}

TEST_CASE("sockets that a dying actor closes finish their work before the world ends",
          "[scheduler][ACT-11]") {
  using protocol = boost::asio::local::stream_protocol;
  struct owning_state {
    std::optional<protocol::socket> socket;
    std::array<char, 16> octets{};
  };
  bool finished = false;
  {
    io::loop loop;
    protocol::socket there(io::context_of(loop));
    world world({.loop = &loop});
    using owning_pointer = actor_pointer<owning_state, mark_actor>;
    const auto owner = world.spawn("", [&](owning_pointer self) -> mark_actor::behavior_type {
      auto& state = self->state;
      state.socket.emplace(io::context_of(loop));
      boost::asio::local::connect_pair(*state.socket, there);
      state.socket->async_read_some(boost::asio::buffer(state.octets),
                                    [&](const auto& error, std::size_t) { finished = !!error; });
      return {[](mark) {}};
    });
    world.run_for(1s);
    CHECK(!finished);
  }
  CHECK(finished);
}

TEST_CASE("an unreachable actor ends by itself and is not kept alive by the scheduler",
          "[scheduler][ACT-12]") {
  world world;
  for (int i = 0; i < 1000; ++i) {
    world.spawn("", mute);
    world.run_for(1ms);
    REQUIRE(counted_state::alive == 0);
  }
}

TEST_CASE("killing ends actors that handles keep alive, with and without a first turn",
          "[scheduler][ACT-11]") {
  world world;
  const auto one = world.spawn("", keeping, mark_actor());
  world.run_for(1s);
  const auto two = world.spawn("", keeping, one);
  CHECK(counted_state::alive == 2);
  world.scheduler().kill_all();
  CHECK(counted_state::alive == 0);
  post(one, mark{});
  post(two, mark{});
  CHECK(world.drain(0)); // there is no actor to become ready
}

TEST_CASE("handles that outlive the shutdown do no harm", "[scheduler][ACT-11]") {
  world world;
  events log;
  const auto one = world.spawn("", keeping, mark_actor());
  const auto two = world.spawn("two", recorder, &log, 0);
  world.run_for(1s);
  world.shutdown();
  CHECK(counted_state::alive == 0);
  CHECK(log.empty());
  for (const auto& x : {one, two}) {
    CHECK(x.get().has_ended());
    CHECK(x.id() != 0);
  }
}

TEST_CASE("a closed clock takes no more orders", "[scheduler][ACT-11]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  post_after(to, 1s, mark{});
  world.scheduler().close_clock();
  CHECK(!world.scheduler().next_timeout());
  post_after(to, 1s, mark{});
  CHECK(!world.scheduler().next_timeout());
  world.run_for(2s);
  CHECK(log.empty());
}

TEST_CASE("shutting down twice is harmless and leaves trace and figures", "[scheduler][ACT-11]") {
  world world;
  events log;
  post_after(world.spawn("a", recorder, &log, 0), 1s, mark{});
  world.run_for(2s);
  const auto stats = world.stats();
  const auto hash = world.trace().hash();
  world.shutdown();
  world.shutdown();
  CHECK(world.stats().resumes == stats.resumes);
  CHECK(world.stats().timeouts == 1);
  CHECK(world.trace().hash() == hash);
}

TEST_CASE("hundreds of worlds can follow and contain each other", "[scheduler]") {
  for (int i = 0; i < 300; ++i) {
    world outer;
    world inner;
    events log;
    post_after(outer.spawn("a", recorder, &log, 0), 1s, mark{1});
    post_after(inner.spawn("a", recorder, &log, 0), 1s, mark{2});
    inner.run_for(1s);
    outer.run_for(1s);
    REQUIRE(log == events{{1s, 2}, {1s, 1}});
  }
}
