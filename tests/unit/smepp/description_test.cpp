#include "core/numbers/random.hpp"
#include "smepp/groups/group_description.hpp"
#include "smepp/peer_description.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::smepp;

namespace {

std::string problem_of(std::string_view xml) {
  const auto x = parse_peer_description(xml);
  const auto* const problem = std::get_if<xml_problem>(&x);
  return problem != nullptr ? to_string(*problem) : "none";
}

} // namespace

TEST_CASE("a peer's XML and its bitmask say the same", "[smepp][SMP-11]") {
  for (transducer_mask mask = 0; mask <= all_transducers; mask = mask * 2 + 1) {
    const peer_description x{mote_id{7}, mask};
    CHECK(std::get<peer_description>(parse_peer_description(to_xml(x))) == x);
  }
  for (std::size_t i = 0; i < transducer_names.size(); ++i) {
    const peer_description x{mote_id{mote_id_max}, transducer_mask{1} << i};
    CHECK(std::get<peer_description>(parse_peer_description(to_xml(x))) == x);
  }
  CHECK(to_xml({mote_id{7}, 5}) == "<peer id=\"7\">\n  <transducer type=\"temperature\"/>\n"
                                   "  <transducer type=\"light\"/>\n</peer>\n");
}

TEST_CASE("XML may be formatted as XML may", "[smepp][SMP-11]") {
  const auto x =
      parse_peer_description("<?xml version=\"1.0\" encoding='UTF-8'?>\n<!-- a mote -->\n"
                             "<peer id = '12' >\n<!-- two --><transducer\n type='led' />"
                             "<transducer type=\"relay\"> </transducer >\r\n</peer >\n");
  CHECK(std::get<peer_description>(x) == peer_description{mote_id{12}, 1U << 12 | 1U << 13});
  CHECK(problem_of("<peer id=\"1\"/>") == "none");
}

TEST_CASE("bad XML is refused with its place", "[smepp][SMP-11]") {
  CHECK(problem_of("") == "1:1: '<peer' expected");
  CHECK(problem_of("<mote id='1'/>") == "1:1: '<peer' expected");
  CHECK(problem_of("<peer/>") == "1:6: an attribute expected");
  CHECK(problem_of("<peer id='0'/>") == "1:11: '0' is not the id of a mote (1..65532)");
  CHECK(problem_of("<peer id='65533'/>") == "1:11: '65533' is not the id of a mote (1..65532)");
  CHECK(problem_of("<peer id='99999999999'/>") ==
        "1:11: '99999999999' is not the id of a mote (1..65532)");
  CHECK(problem_of("<peer id='x1'/>") == "1:11: 'x1' is not the id of a mote (1..65532)");
  CHECK(problem_of("<peer id='1'>") == "1:14: '<transducer' expected");
  CHECK(problem_of("<peer id='1'>\n <transducer type='lamp'/></peer>") ==
        "2:20: 'lamp' is not a transducer");
  CHECK(problem_of("<peer id='1'><transducer type='led'/>\n<transducer type='led'/></peer>") ==
        "2:19: 'led' is present twice");
  CHECK(problem_of("<peer id='1'><transducer kind='led'/></peer>") == "1:26: 'type' expected");
  CHECK(problem_of("<peer id='1'></peer><peer/>") == "1:21: unexpected text after the peer");
  CHECK(problem_of("<peer id='1&#48;'/>") == "1:12: this character is not allowed here");
  CHECK(problem_of("<!-- <peer id='1'/>") == "1:1: comment without end");
  CHECK(problem_of("<?xml version=\"1.0\" x='1'?><peer id='1'/>") == "1:21: '?>' expected");
}

TEST_CASE("octets of any kind do not upset the XML reader", "[smepp][SMP-11]") {
  random_stream rng(3);
  const auto good = to_xml({mote_id{7}, 0x1234});
  for (int i = 0; i < 20'000; ++i) {
    auto text = good;
    for (auto edits = 1 + rng.below(4); edits > 0; --edits) {
      const auto at = rng.below(text.size());
      if (rng.chance(0.3))
        text.erase(at, rng.below(10));
      else
        text[at] = static_cast<char>(rng.below(256));
      text += '\n';
    }
    const auto x = parse_peer_description(text);
    if (const auto* const peer = std::get_if<peer_description>(&x))
      CHECK((peer->transducers & ~all_transducers) == 0);
  }
}

TEST_CASE("a group's description is checked", "[smepp][SMP-04][SMP-05]") {
  group_description x;
  x.name = "kitchen";
  CHECK(x.is_valid());
  x.is_closed = true;
  CHECK_FALSE(x.is_valid()); // without a key none could enter
  x.master = key();
  CHECK(x.is_valid());
  x.management = {2s, 100ms};
  CHECK(x.is_valid());
  x.management = {2s, 3s};
  CHECK_FALSE(x.is_valid());
  x.management = {66s, 1s};
  CHECK_FALSE(x.is_valid());
  x.management = {};
  x.name = std::string(21, 'x');
  CHECK_FALSE(x.is_valid());
  x.name = "tab\t";
  CHECK_FALSE(x.is_valid());
}

TEST_CASE("groups are found by name or security properties", "[smepp][SMP-06]") {
  group_description x{"kitchen", key(), true, false, {}};
  CHECK(group_filter{}.matches(x));
  CHECK(group_filter{.name = "kitchen"}.matches(x));
  CHECK_FALSE(group_filter{.name = "bath"}.matches(x));
  CHECK(group_filter{.is_closed = true}.matches(x));
  CHECK_FALSE(group_filter{.is_closed = false}.matches(x));
  CHECK_FALSE(group_filter{.name = "kitchen", .is_private = true}.matches(x));
}

TEST_CASE("the same name elsewhere is another group", "[smepp][SMP-04]") {
  CHECK(id_of("kitchen", mote_id{1}) != id_of("kitchen", mote_id{2}));
  CHECK(id_of("kitchen", mote_id{1}) != id_of("bath", mote_id{1}));
  for (std::uint16_t i = 1; i < 2000; ++i)
    CHECK(id_of("x", mote_id{i}) != network_level);
}
