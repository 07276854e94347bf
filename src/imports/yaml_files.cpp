// Files of OTNS in YAML, and of IoT-LAB in JSON, which is read as YAML for the places of its
// values.
#include <algorithm>
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "core/text/json.hpp"
#include "imports/readers.hpp"

namespace rubicon::imports {

namespace {

text_place mark_of(const YAML::Node& x) {
  const auto mark = x.Mark();
  if (mark.is_null())
    return {};
  return {static_cast<std::size_t>(mark.line) + 1, static_cast<std::size_t>(mark.column) + 1};
}

YAML::Node yaml_of(std::string_view text) {
  try {
    return YAML::Load(std::string(text));
  } catch (const YAML::Exception& x) {
    const text_place at{static_cast<std::size_t>(x.mark.line + 1), // it may count an end of its own
                        std::min(static_cast<std::size_t>(x.mark.column + 1), text.size() + 1)};
    refuse(at, x.msg);
  }
}

/// A value of a map; undefined if there is none. What the library returns for none throws at
/// whatever else is asked of it.
YAML::Node child(const YAML::Node& x, const char* name) {
  const YAML::Node none(YAML::NodeType::Undefined);
  if (!x.IsDefined() || !x.IsMap())
    return none;
  const auto found = x[name];
  return found.IsDefined() ? found : none;
}

field scalar(const YAML::Node& x, const char* what) {
  if (!x.IsScalar())
    refuse(mark_of(x), std::string(what) + " must be a single value");
  return {x.Scalar(), mark_of(x)};
}

class otns_reader {
public:
  import_result read(const YAML::Node& root) {
    const auto nodes = child(root, "nodes");
    if (!root.IsMap() || !nodes.IsDefined() || !nodes.IsSequence())
      refuse({1, 1}, "there is no list `nodes`");
    const auto network = child(root, "network");
    if (const auto range = child(network, "radio-range"); range.IsDefined())
      range_ = disk{real_of(scalar(range, "radio-range"), "radio-range", 1, coordinate_max_m), 0};
    if (const auto shift = child(network, "pos-shift"); shift.IsDefined())
      shift_ = place(shift);
    if (const auto base = child(network, "base-id"); base.IsDefined())
      base_ = node_of(scalar(base, "base-id"));
    for (const auto& each : nodes)
      read_node(each);
    for (const auto& each : root)
      if (const auto key = scalar(each.first, "a key");
          key.text != "nodes" && key.text != "network")
        notes_.add(key.at, quoted(key.text));
    out_.plan.air = range_;
    return finished(std::move(out_), motes_, notes_);
  }

private:
  static point place(const YAML::Node& x) {
    if (!x.IsSequence() || x.size() < 2 || x.size() > 3)
      refuse(mark_of(x), "a position must be two or three numbers");
    const auto z = x.size() == 3 ? coordinate_of(scalar(x[2], "z"), "z") : 0.0;
    return {coordinate_of(scalar(x[0], "x"), "x"), coordinate_of(scalar(x[1], "y"), "y"), z};
  }

  void read_node(const YAML::Node& x) {
    const auto id = child(x, "id");
    const auto pos = child(x, "pos");
    if (!id.IsDefined() || !pos.IsDefined())
      refuse(mark_of(x), "a node needs `id` and `pos`");
    const auto number = base_ + node_of(scalar(id, "id"));
    if (number > node_max)
      refuse(mark_of(id), "`base-id` and `id` must be at most " + std::to_string(node_max) +
                              " together, not " + std::to_string(number));
    if (motes_.has_number(number))
      refuse(mark_of(id), "there are two nodes with the id " + std::to_string(number));
    auto& mote = motes_.at(motes_.by_number(number, mark_of(id)));
    const auto p = place(pos);
    mote.place = {p.x_m + shift_.x_m, p.y_m + shift_.y_m, p.z_m + shift_.z_m};
    for (const auto coordinate : {mote.place.x_m, mote.place.y_m, mote.place.z_m})
      if (std::abs(coordinate) > coordinate_max_m)
        refuse(mark_of(pos), "with `pos-shift` it is more than " +
                                 std::to_string(static_cast<long>(coordinate_max_m)) +
                                 " m away from the origin");
    for (const auto& each : x)
      if (const auto key = scalar(each.first, "a key"); key.text != "id" && key.text != "pos")
        notes_.add(key.at, quoted(key.text) + " of nodes");
  }

  imported out_;
  mote_list motes_;
  note_list notes_;
  disk range_{220, 0}; // OTNS's default
  point shift_;
  std::uint32_t base_ = 0;
};

class iotlab_reader {
public:
  import_result read(const YAML::Node& root) {
    const auto items = root.IsMap() ? child(root, "items") : root;
    if (!items.IsDefined() || !items.IsSequence())
      refuse({1, 1}, "there is no list of nodes, nor a list `items`");
    for (const auto& each : items)
      read_node(each);
    if (motes_.size() == 0 && items.size() > 0)
      refuse(mark_of(items[0]), "no node has a position");
    notes_.add({}, "what radios receive there: a disk of 50 m instead");
    return finished(std::move(out_), motes_, notes_);
  }

private:
  void read_node(const YAML::Node& x) {
    const auto address = child(x, "network_address");
    if (!address.IsDefined())
      refuse(mark_of(x), "a node needs `network_address`");
    const auto full = scalar(address, "network_address");
    const auto name = full.text.substr(0, full.text.find('.'));
    point place;
    for (const auto& [key, value] :
         {std::pair("x", &place.x_m), std::pair("y", &place.y_m), std::pair("z", &place.z_m)}) {
      const auto found = child(x, key);
      const auto text = found.IsDefined() && found.IsScalar() ? found.Scalar() : std::string();
      if (text.find_first_not_of(' ') == std::string::npos)
        return notes_.add(mark_of(x), "nodes without a position");
      *value = coordinate_of({text, mark_of(found)}, key);
    }
    if (motes_.has_name(name))
      refuse(full.at, "there are two nodes " + quoted(name));
    auto& mote = motes_.at(motes_.by_name(name, full.at));
    mote.place = place;
    if (const auto kind = child(x, "archi"); kind.IsDefined()) {
      const auto text = scalar(kind, "archi");
      if (text.text.ends_with(":cc2420"))
        mote.platform = "telosb";
      else
        notes_.add(text.at, "radio of " + quoted(text.text));
    }
    if (const auto moves = child(x, "mobile");
        moves.IsDefined() && moves.IsScalar() && moves.Scalar() == "1")
      notes_.add(mark_of(moves), "movements of mobile nodes");
  }

  imported out_;
  mote_list motes_;
  note_list notes_;
};

} // namespace

import_result read_otns(std::string_view text) {
  try {
    return otns_reader().read(yaml_of(text));
  } catch (const YAML::Exception& x) {
    refuse({}, x.msg);
  }
}

import_result read_iotlab(std::string_view text) {
  try {
    [[maybe_unused]] const auto strict = parse_json(text);
  } catch (const nlohmann::json::parse_error& x) {
    refuse(place_of(text, x.byte == 0 ? 0 : x.byte - 1), "this is no JSON");
  } catch (const nlohmann::json::exception&) {
    refuse({1, 1}, "a number in it is too large");
  }
  try {
    return iotlab_reader().read(yaml_of(text));
  } catch (const YAML::Exception& x) {
    refuse({}, x.msg);
  }
}

} // namespace rubicon::imports
