#include "core/bounded_queue.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("a full queue drops by its policy and counts it", "[core]") {
  bounded_queue<int> newest(2, overflow::drop_newest);
  CHECK(newest.push(1));
  CHECK(newest.push(2));
  CHECK_FALSE(newest.push(3));
  CHECK(newest.dropped() == 1);
  CHECK(newest.pop() == 1);
  CHECK(newest.pop() == 2);
  CHECK(newest.empty());

  bounded_queue<int> oldest(2, overflow::drop_oldest);
  for (int i = 1; i <= 5; ++i)
    CHECK(oldest.push(i));
  CHECK(oldest.dropped() == 3);
  CHECK(oldest.pop() == 4);
}

TEST_CASE("a queue without capacity takes nothing", "[core]") {
  for (const auto policy : {overflow::drop_newest, overflow::drop_oldest}) {
    bounded_queue<int> queue(0, policy);
    CHECK_FALSE(queue.push(1));
    CHECK(queue.empty());
    CHECK(queue.dropped() == 1);
  }
}
