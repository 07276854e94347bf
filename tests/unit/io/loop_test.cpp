#include <array>
#include <chrono>
#include <thread>

#include <boost/asio/buffer.hpp>
#include <boost/asio/local/connect_pair.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>

#include "io/context.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace std::chrono_literals;

namespace {

auto real_now() {
  return std::chrono::steady_clock::now();
}

} // namespace

TEST_CASE("polling runs what is ready and never waits", "[io]") {
  io::loop loop;
  CHECK(loop.poll() == 0);
  int runs = 0;
  for (int i = 0; i < 3; ++i)
    boost::asio::post(io::context_of(loop), [&] { ++runs; });
  CHECK(runs == 0);
  CHECK(loop.poll() == 3);
  CHECK(runs == 3);
  CHECK(loop.poll() == 0);
}

TEST_CASE("a wait with nothing to do lasts until its time", "[io][GEN-07]") {
  io::loop loop;
  for (const auto length : {20ms, 5ms, 10ms}) {
    const auto until = real_now() + length;
    CHECK(loop.wait_until(until) == 0);
    CHECK(real_now() >= until);
  }
}

TEST_CASE("a wait for a time that has passed runs what is ready", "[io]") {
  io::loop loop;
  int runs = 0;
  boost::asio::post(io::context_of(loop), [&] { ++runs; });
  CHECK(loop.wait_until(real_now() - 1s) == 1);
  CHECK(runs == 1);
}

TEST_CASE("another thread wakes the loop from a wait", "[io]") {
  io::loop loop;
  const auto start = real_now();
  std::thread other([&] { loop.wake(); });
  CHECK(loop.wait_until(start + 1h) == 0);
  other.join();
  CHECK(real_now() < start + 1h);
}

TEST_CASE("a wake that comes before the wait ends it", "[io]") {
  io::loop loop;
  loop.wake();
  const auto start = real_now();
  CHECK(loop.wait_until(start + 1h) == 0);
  CHECK(real_now() < start + 1h);
}

TEST_CASE("a wait can follow one that was given up, for an earlier or a later time", "[io]") {
  io::loop loop;
  loop.wake();
  loop.wait_until(real_now() + 1h);
  auto until = real_now() + 5ms;
  CHECK(loop.wait_until(until) == 0);
  CHECK(real_now() >= until);
  loop.wake();
  loop.wait_until(real_now() + 2ms);
  until = real_now() + 10ms;
  CHECK(loop.wait_until(until) == 0);
  CHECK(real_now() >= until);
}

TEST_CASE("octets on a socket end a wait", "[io]") {
  using protocol = boost::asio::local::stream_protocol;
  io::loop loop;
  protocol::socket here(io::context_of(loop));
  protocol::socket there(io::context_of(loop));
  boost::asio::local::connect_pair(here, there);
  std::array<char, 8> octets{};
  std::size_t received = 0;
  here.async_read_some(boost::asio::buffer(octets), [&](const auto& error, std::size_t size) {
    CHECK(!error);
    received = size;
  });
  CHECK(loop.poll() == 0);
  boost::asio::write(there, boost::asio::buffer("abc", 3));
  CHECK(loop.wait_until(real_now() + 1h) == 1);
  CHECK(received == 3);
}
