#include "peis/link/link.hpp"
#include "peis/wire/package.hpp"
#include "peis/wire/package_walk.hpp"
#include "support/catch.hpp"
#include "unit/peis/overlay/numbered_package.hpp"

using namespace rubicon;
using namespace rubicon::peis;
using rubicon::peis::test::numbered_package;

namespace {

bytes operator+(bytes a, const bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const bytes request = encode(connect_request{});
const bytes empty_package = numbered_package(1, 0);
const bytes longest_package = numbered_package(2, 1024);
const bytes short_package = numbered_package(3, 7);

thinned thin(const bytes& octets, std::vector<bool> lost, std::size_t kept = 0) {
  std::size_t asked = 0;
  auto out = without_lost_packages(octets, kept, [&] { return lost.at(asked++); });
  CHECK(asked == lost.size());
  return out;
}

} // namespace

TEST_CASE("lost packages are taken out whole", "[peis]") {
  const auto all = empty_package + longest_package + short_package;
  CHECK(thin(all, {false, false, false}).octets == all);
  const auto middle = thin(all, {false, true, false});
  CHECK(middle.octets == empty_package + short_package);
  CHECK(middle.lost == 1);
  CHECK(middle.lost_octets == longest_package);
  CHECK(thin(all, {true, false, true}).octets == longest_package);
  const auto none = thin(all, {true, true, true});
  CHECK(none.octets.empty());
  CHECK(none.lost == 3);
  CHECK(thin({}, {}).lost == 0);
}

TEST_CASE("a connect request is never lost", "[peis]") {
  CHECK(
      thin(request + empty_package + longest_package, {true, true}, connect_request_size).octets ==
      request);
  CHECK(thin(request, {}, connect_request_size).octets == request);
  const bytes piece(10, 0);
  CHECK(thin(piece, {}, connect_request_size).octets == piece);
}

TEST_CASE("what is no whole package is left as it is", "[peis]") {
  auto cut = longest_package;
  cut.pop_back();
  CHECK(thin(empty_package + cut, {true}).octets == cut);
  const bytes noise(100, 0xff);
  const auto x = thin(empty_package + noise + short_package, {true});
  CHECK(x.octets == noise + short_package);
  CHECK(x.lost == 1);
}
