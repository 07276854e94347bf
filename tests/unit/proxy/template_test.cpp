#include <string>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "proxy/classes/tuple_template.hpp"
#include "proxy/proxy.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"

using namespace rubicon;
using rubicon::proxy::encoding;
using rubicon::proxy::proxy_class;
using rubicon::proxy::template_part;
using rubicon::proxy::template_parts;
using rubicon::proxy::tuple_templates;
using test::start;

namespace {

using lines = std::vector<std::string>;

lines lines_of(const std::vector<tuple_templates::tuple>& tuples) {
  lines out;
  for (const auto& x : tuples)
    out.push_back(x.key + " = " + x.text);
  return out;
}

proxy_class climate_with_door() {
  proxy_class x;
  x.name = "climate";
  x.properties = {{"colour", "white"}};
  x.fields = {{"temperature", 1, 0, encoding::i16, 0.1, 0, 1, "C", {}},
              {"humidity", 1, 2, encoding::u8, 1, 0, 0, "%", {}},
              {"door", 2, 0, encoding::u8, 1, 0, 0, "", {{0, "closed"}, {1, "open"}}}};
  return x;
}

const proxy::name_values names{{"island", "kitchen"}, {"id", "7"}, {"name", "climate-7"}};

} // namespace

TEST_CASE("a template is text and names in braces", "[proxy][PXY-04]") {
  using parts = std::vector<template_part>;
  CHECK(*template_parts("a {b} {{c}}") == parts{{"a ", false}, {"b", true}, {" {c}", false}});
  CHECK(*template_parts("{a}{b.unit}") == parts{{"a", true}, {"b.unit", true}});
  CHECK(template_parts("")->empty());
  for (const auto* wrong : {"{", "}", "{}", "{a", "a}", "{a{b}}", "{a}}"}) {
    CAPTURE(wrong);
    CHECK(template_parts(wrong).error() == errc::bad_value);
  }
}

TEST_CASE("a text template has values, units and prior names", "[proxy][PXY-04][PXY-05]") {
  auto what = climate_with_door();
  what.tuples = {
      {"{room}.{name}.text", "{temperature} {temperature.unit}, {humidity}% in {room}", {}},
      {"{island}.about-{id}", "a {colour} {class}", {}},
      {"door.{name}", "{door}", {}}};
  const tuple_templates aut(what, names);
  CHECK(lines_of(aut.at_start()) == lines{"kitchen.about-7 = a  climate"});

  auto with_colour = names;
  with_colour.emplace_back("colour", "white");
  const tuple_templates known(what, with_colour);
  CHECK(lines_of(known.at_start()) == lines{"kitchen.about-7 = a white climate"});
  const auto readings = *proxy::decode(what, 1, bytes{0x00, 0xdf, 45});
  CHECK(lines_of(known.on_readings(1, readings, start)) ==
        lines{"kitchen.climate-7.text = 22.3 C, 45% in kitchen"});
  CHECK(lines_of(known.on_readings(2, *proxy::decode(what, 2, bytes{1}), start)) ==
        lines{"door.climate-7 = open"});
}

TEST_CASE("the room is the property of that name, else the island", "[proxy][PXY-05]") {
  auto what = climate_with_door();
  what.tuples = {{"{room}.text", "here", {}}};
  auto with_room = names;
  with_room.emplace_back("room", "the larder.2");
  CHECK(lines_of(tuple_templates(what, with_room).at_start()) == lines{"the_larder_2.text = here"});
}

TEST_CASE("a JSON template has numbers, units and the time of its message", "[proxy][PXY-04]") {
  auto what = climate_with_door();
  what.tuples = {{"{room}.climate", "", {"humidity", "temperature"}},
                 {"{room}.door", "", {"door"}}};
  const tuple_templates aut(what, names);
  CHECK(aut.at_start().empty());
  CHECK(lines_of(
            aut.on_readings(1, *proxy::decode(what, 1, bytes{0x00, 0xdf, 45}), start + 12500ms)) ==
        lines{R"(kitchen.climate = {"time":12.5,"humidity":{"value":45.0,"unit":"%"},)"
              R"("temperature":{"value":22.3,"unit":"C"}})"});
  CHECK(lines_of(aut.on_readings(2, *proxy::decode(what, 2, bytes{1}), start)) ==
        lines{R"(kitchen.door = {"time":0.0,"door":{"value":"open"}})"});
  // A count without a word is a word as well.
  CHECK(lines_of(aut.on_readings(2, *proxy::decode(what, 2, bytes{9}), start)) ==
        lines{R"(kitchen.door = {"time":0.0,"door":{"value":"9"}})"});
}

TEST_CASE("a unit that is no UTF-8 does not break the JSON", "[proxy][PXY-04]") {
  auto what = climate_with_door();
  what.fields[0].unit = "\xb0"
                        "C";
  what.tuples = {{"t", "", {"temperature"}}};
  const auto all = tuple_templates(what, names)
                       .on_readings(1, *proxy::decode(what, 1, bytes{0x00, 0xdf, 45}), start);
  REQUIRE(all.size() == 1);
  CHECK(all[0].text.find("\xef\xbf\xbd"
                         "C") != std::string::npos);
}

TEST_CASE("a proxy sets its templates beside its other tuples", "[proxy][PXY-04]") {
  auto what = climate_with_door();
  what.tuples = {{"{room}.temperature", "{temperature} C", {}},
                 {"a.b.c.d.e.f.{name}.too-long", "x", {}}};
  proxy::proxy aut(what, {{island_id{5}, mote_id{7}}, "kitchen", "climate-7"});
  static_cast<void>(aut.start(start));
  CHECK(aut.counters().bad_keys == 1);
  const auto out = aut.on_output(1, bytes{0x00, 0xdf, 45}, start + 1s);
  REQUIRE(out.size() == 3);
  const auto& set = std::get<proxy::publish>(out[2]);
  CHECK(set.key == "kitchen.temperature");
  CHECK(set.text == "22.3 C");
  CHECK(std::get<proxy::publish>(out[0]).key == "kitchen.climate-7.temperature");
}
