#include "peis/link.hpp"
#include "peis/package.hpp"
#include "peis/package_walk.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::peis;

namespace {

bytes package(std::uint8_t id, std::size_t length) {
  package_header header;
  header.id = id;
  header.source = peer_id{1};
  header.length = static_cast<std::uint16_t>(length);
  bytes out;
  encode(header, out);
  out.resize(out.size() + length, id);
  return out;
}

bytes operator+(bytes a, const bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const bytes request = encode(connect_request{});
const bytes first = package(1, 0);
const bytes second = package(2, 1024);
const bytes third = package(3, 7);

thinned without(const bytes& octets, std::vector<bool> lost, std::size_t kept = 0) {
  std::size_t asked = 0;
  auto out = without_lost_packages(octets, kept, [&] { return lost.at(asked++); });
  CHECK(asked == lost.size());
  return out;
}

} // namespace

TEST_CASE("lost packages are taken out whole", "[peis]") {
  const auto all = first + second + third;
  CHECK(without(all, {false, false, false}).octets == all);
  const auto middle = without(all, {false, true, false});
  CHECK(middle.octets == first + third);
  CHECK(middle.lost == 1);
  CHECK(middle.lost_octets == second);
  CHECK(without(all, {true, false, true}).octets == second);
  const auto none = without(all, {true, true, true});
  CHECK(none.octets.empty());
  CHECK(none.lost == 3);
  CHECK(without({}, {}).lost == 0);
}

TEST_CASE("a connect request is never lost", "[peis]") {
  CHECK(without(request + first + second, {true, true}, connect_request_size).octets == request);
  CHECK(without(request, {}, connect_request_size).octets == request);
  const bytes piece(10, 0);
  CHECK(without(piece, {}, connect_request_size).octets == piece);
}

TEST_CASE("what is no whole package is left as it is", "[peis]") {
  auto cut = second;
  cut.pop_back();
  CHECK(without(first + cut, {true}).octets == cut);
  const bytes noise(100, 0xff);
  const auto x = without(first + noise + third, {true});
  CHECK(x.octets == noise + third);
  CHECK(x.lost == 1);
}
