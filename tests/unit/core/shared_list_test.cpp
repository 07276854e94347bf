#include "core/shared_list.hpp"

#include <string>

#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("copies of a list share their elements until one is edited", "[core]") {
  shared_list<std::string> first{"one", "two"};
  auto second = first;
  CHECK(&first.all() == &second.all());
  second.edit().push_back("three");
  CHECK(first.all() == std::vector<std::string>{"one", "two"});
  CHECK(second.all() == std::vector<std::string>{"one", "two", "three"});
  const auto* own = &second.all();
  second.edit()[0] = "1"; // it is not shared: it stays where it is
  CHECK(&second.all() == own);
  CHECK(first[0] == "one");
  CHECK(second.at(0) == "1");
  CHECK(first != second);
}

TEST_CASE("a list without elements is read and edited like any other", "[core]") {
  shared_list<int> none;
  const shared_list<int> also_none{std::vector<int>{}};
  CHECK(none.empty());
  CHECK(none.begin() == none.end());
  CHECK(none == also_none);
  none.edit().push_back(7);
  CHECK(none.size() == 1);
  CHECK(none != also_none);
}
