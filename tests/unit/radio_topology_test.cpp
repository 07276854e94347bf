#include <string>

#include "radio/parameters.hpp"
#include "radio/topology.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

std::string names(const hearers& list) {
  std::string all;
  for (const auto& x : list)
    all += to_string(x.radio) + ' ';
  return all;
}

} // namespace

TEST_CASE("a radio is heard exactly within the range", "[radio][topology][NET-15]") {
  topology x(30, 0.25);
  const auto a = x.add({0, 0, 0});
  const auto b = x.add({30, 0, 0});
  const auto c = x.add({30.001, 0, 0});
  const auto d = x.add({0, 18, 24}); // 30 m away in space
  CHECK(names(*x.around(a)) == "1 3 ");
  CHECK(names(*x.around(b)) == "0 2 ");
  CHECK(names(*x.around(c)) == "1 ");
  CHECK(names(*x.around(d)) == "0 ");
  CHECK(x.around(a)->front().loss == 0.25F);
  CHECK(x.size() == 4);
}

TEST_CASE("moving a radio renews its lists and its neighbours'", "[radio][topology]") {
  topology x(30, 0);
  const auto a = x.add({0, 0, 0});
  const auto b = x.add({100, 0, 0});
  const auto c = x.add({10, 0, 0});
  x.set_loss(a, b, 1);
  const auto before = x.around(a);
  x.move(b, {5, 0, 0});
  CHECK(names(*before) == "2 "); // whoever holds a list keeps it
  CHECK(names(*x.around(a)) == "1 2 ");
  CHECK(names(*x.around(b)) == "0 2 ");
  CHECK(names(*x.around(c)) == "0 1 ");
  CHECK(x.around(a)->front().loss == 1); // said before they met
  CHECK(x.around(b)->front().loss == 0); // one direction only
  x.move(b, {100, 0, 0});
  CHECK(names(*x.around(a)) == "2 ");
  CHECK(x.around(b)->empty());
}

TEST_CASE("signals weaken with distance as documented", "[radio][topology]") {
  CHECK(signal_at(0) == signal{-40, 110});
  CHECK(signal_at(1) == signal{-40, 110});
  CHECK(signal_at(10) == signal{-70, 110});
  CHECK(signal_at(30) == signal{-85, 80}); // -84.3 rounded down
  CHECK(signal_at(50) == signal{-91, 62});
  CHECK(signal_at(1000) == signal{-100, 50}); // below what the chips report
  for (double d = 1; d < 200; d += 0.5)
    CHECK(signal_at(d + 0.5).rssi_dbm <= signal_at(d).rssi_dbm);
}

TEST_CASE("the three platforms are known by name", "[radio][platform]") {
  for (const auto& x : platforms()) {
    CHECK(find_platform(x.name) == &x);
    CHECK(x.mcu_active_ma > x.mcu_sleep_ma);
    CHECK(x.radio_listen_ma > x.radio_off_ma);
    CHECK(x.radio_transmit_ma > x.radio_off_ma);
    CHECK(x.receive_slots == 3);
    CHECK(x.service_time >= 1ms);
    CHECK(x.service_time <= 3ms);
  }
  CHECK(find_platform("micaz")->serial_baud == 57600);
  CHECK(find_platform("iris")->serial_baud == 57600);
  CHECK(find_platform("telosb")->serial_baud == 115200);
  CHECK(find_platform("telosb")->mcu_active_ma == 1.8);
  CHECK(find_platform("iris")->radio_transmit_ma == 16.5);
  CHECK(find_platform("mica2") == nullptr);
  CHECK(find_platform("") == nullptr);
}
