// Simulations of Contiki's Cooja, as its .csc files have them: XML.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include <pugixml.hpp>

#include "imports/readers.hpp"

namespace rubicon::imports {

namespace {

constexpr std::string_view blanks = " \t\r\n";
constexpr double udgm_default_range_m = 50;

/// The text of an element without blanks around it.
std::string_view text_of(const pugi::xml_node& x) {
  const std::string_view text = x.child_value();
  const auto begin = text.find_first_not_of(blanks);
  return begin == std::string_view::npos
             ? std::string_view()
             : text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// The last part of a class's name, which stands in front of an element's children.
std::string_view class_of(const pugi::xml_node& x) {
  const auto text = text_of(x);
  const auto dot = text.rfind('.');
  return dot == std::string_view::npos ? text : text.substr(dot + 1);
}

class cooja_reader {
public:
  explicit cooja_reader(std::string_view text) : text_(text), places_(text) {}

  import_result read() {
    const auto parsed = document_.load_buffer(text_.data(), text_.size());
    if (!parsed)
      refuse(at(parsed.offset), parsed.description());
    const auto conf = document_.child("simconf");
    if (!conf)
      refuse({1, 1}, "there is no element `simconf`");
    const auto simulation = conf.child("simulation");
    if (!simulation)
      refuse(at(conf), "there is no element `simulation` in `simconf`");
    out_.plan.title = simulation.child_value("title");
    read_seed(simulation);
    read_types(simulation);
    for (const auto& mote : simulation.children("mote"))
      read_mote(mote, mote.child_value("motetype_identifier"));
    read_medium(simulation);
    for (const auto& plugin : conf.children("plugin"))
      notes_.add(at(plugin), "plugin " + quoted(class_of(plugin)));
    for (const auto& child : simulation.children())
      note_other(child);
    return finished(std::move(out_), motes_, notes_);
  }

private:
  [[nodiscard]] text_place at(std::ptrdiff_t offset) const {
    return places_.at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, offset)));
  }

  [[nodiscard]] text_place at(const pugi::xml_node& x) const { return at(x.offset_debug()); }

  [[nodiscard]] field content(const pugi::xml_node& x) const {
    const auto text = text_of(x);
    return {text, at(text.empty() ? x : x.first_child())};
  }

  [[nodiscard]] double number(const pugi::xml_node& parent, const char* name, double otherwise,
                              double most) const {
    const auto x = parent.child(name);
    return x ? real_of(content(x), name, 0, most) : otherwise;
  }

  void note_other(const pugi::xml_node& x) {
    constexpr std::array taken{"title", "randomseed", "radiomedium", "motetype", "mote"};
    const std::string_view name = x.name();
    if (x.type() == pugi::node_element &&
        std::none_of(taken.begin(), taken.end(), [&](const char* y) { return name == y; }))
      notes_.add(at(x), "element " + quoted(name));
  }

  void read_seed(const pugi::xml_node& simulation) {
    const auto x = simulation.child("randomseed");
    if (!x)
      return;
    const auto text = content(x);
    if (text.text == "generated")
      return notes_.add(at(x), "a seed drawn for each run: `run --seed` gives one");
    const auto seed = whole_in(text.text);
    if (!seed || *seed > 0x7fffffffffffffffU)
      refuse(text.at, "the seed must be a whole number or `generated`, not " + quoted(text.text));
    out_.plan.seed = *seed;
  }

  void read_types(const pugi::xml_node& simulation) {
    for (const auto& type : simulation.children("motetype")) {
      const auto name = class_of(type);
      const std::string id = type.child_value("identifier");
      if (name.starts_with("Z1") || name.starts_with("Sky"))
        platforms_[id] = "telosb"; // the same radio
      else if (name.starts_with("MicaZ"))
        platforms_[id] = "micaz";
      notes_.add(at(type), "firmware of mote type " + quoted(name));
      for (const auto& mote : type.children("mote"))
        read_mote(mote, id);
    }
  }

  struct found_mote {
    std::optional<std::uint32_t> id;
    std::optional<point> place;
  };

  void read_mote(const pugi::xml_node& mote, const std::string& type) {
    found_mote found;
    for (const auto& part : mote.children("interface_config"))
      read_interface(part, found);
    if (!found.id)
      refuse(at(mote), "the mote has no interface with an `id`");
    if (!found.place)
      refuse(at(mote), "the mote has no interface with a position");
    if (motes_.has_number(*found.id))
      refuse(at(mote), "there are two motes with the id " + std::to_string(*found.id));
    auto& out = motes_.at(motes_.by_number(*found.id, at(mote)));
    out.place = *found.place;
    if (const auto platform = platforms_.find(type); platform != platforms_.end())
      out.platform = platform->second;
  }

  void read_interface(const pugi::xml_node& x, found_mote& out) {
    const auto name = class_of(x);
    if (name.ends_with("Position"))
      out.place = place(x);
    else if (const auto id = x.child("id"); id && name.ends_with("ID"))
      out.id = node_of(content(id));
    else
      notes_.add(at(x), "settings of interface " + quoted(name));
  }

  [[nodiscard]] point place(const pugi::xml_node& x) const {
    std::array<double, 3> out{};
    constexpr std::array names{"x", "y", "z"};
    const auto inside = x.child("pos");
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto child = x.child(names[i]);
      const auto attribute = inside.attribute(names[i]);
      if (child)
        out[i] = coordinate_of(content(child), names[i]);
      else if (attribute)
        out[i] = coordinate_of({attribute.value(), at(inside)}, names[i]);
      else if (i < 2)
        refuse(at(x), std::string("the position has no ") + names[i]);
    }
    return {out[0], out[1], out[2]};
  }

  void read_medium(const pugi::xml_node& simulation) {
    const auto medium = simulation.child("radiomedium");
    const auto name = class_of(medium);
    if (name == "UDGM" || name == "UDGMConstantLoss")
      return read_disk(medium, name == "UDGM");
    if (name == "DirectedGraphMedium")
      return read_edges(medium);
    out_.plan.air = disk{udgm_default_range_m, 0};
    notes_.add(medium ? at(medium) : at(simulation),
               "radio medium " + quoted(name) + ": a disk of 50 m instead");
  }

  void read_disk(const pugi::xml_node& medium, bool by_distance) {
    disk out;
    out.range_m = number(medium, "transmitting_range", udgm_default_range_m, coordinate_max_m);
    if (out.range_m < 0.1)
      refuse(at(medium), "transmitting_range must be 0.1 m or more");
    if (const auto far = medium.child("interference_range");
        far && real_of(content(far), "interference_range", 0, coordinate_max_m) != out.range_m)
      notes_.add(at(far), "interference_range: frames disturb as far as they are received");
    const auto sent = number(medium, "success_ratio_tx", 1, 1);
    const auto received = number(medium, "success_ratio_rx", 1, 1);
    out.loss = 1 - sent;
    if (!by_distance)
      out.loss = 1 - sent * received;
    if (sent < 1)
      notes_.add(at(medium.child("success_ratio_tx")),
                 "success_ratio_tx loses a frame at all receivers at once: here at each by itself");
    out_.plan.air = out;
    if (by_distance && received < 1)
      fade(out.range_m, sent, received, medium);
  }

  /// UDGM: the nearer, the more arrives.
  void fade(double range_m, double sent, double received, const pugi::xml_node& medium) {
    for (std::size_t i = 0; i < motes_.size(); ++i)
      for (std::size_t k = 0; k < motes_.size(); ++k) {
        const auto& a = motes_.at(i).place;
        const auto& b = motes_.at(k).place;
        const auto d = std::hypot(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m) / range_m;
        if (i == k || d > 1)
          continue;
        if (out_.plan.links.size() == links_max)
          refuse(at(medium), "success_ratio_rx needs more than 200000 links");
        out_.plan.links.push_back({i, k, 1 - sent * (1 - d * d * (1 - received)), {}});
      }
  }

  void read_edges(const pugi::xml_node& medium) {
    out_.plan.air = listed_links{};
    std::set<std::pair<std::size_t, std::size_t>> seen;
    for (const auto& edge : medium.children("edge")) {
      const auto dest = edge.child("dest");
      const auto from = end_of(edge, edge.child("source"), "source");
      if (dest.child("radio") && content(dest.child("radio")).text == "all")
        refuse(at(dest), "an edge to all radios is not supported");
      const auto to = end_of(edge, dest.child("radio"), "radio");
      if (from == to || !seen.insert({from, to}).second)
        refuse(at(edge), "the edge leads to its own source, or is already listed");
      const auto ratio = number(dest, "ratio", 1, 1);
      const auto signal = dest.child("signal");
      const auto gain = signal ? real_of(content(signal), "signal", -200, 20) : -10;
      if (dest.child("lqi"))
        notes_.add(at(dest.child("lqi")), "lqi of edges, which follows from the signal");
      if (dest.child("delay") && number(dest, "delay", 0, 1e9) > 0)
        notes_.add(at(dest.child("delay")), "delays of edges");
      if (out_.plan.links.size() == links_max)
        refuse(at(edge), "there are more than 200000 links");
      if (ratio > 0)
        out_.plan.links.push_back({from, to, 1 - ratio, gain});
    }
  }

  std::size_t end_of(const pugi::xml_node& edge, const pugi::xml_node& x, const char* name) {
    if (!x)
      refuse(at(edge), std::string("the edge has no `") + name + '`');
    const auto text = content(x);
    const auto id = node_of(text);
    if (!motes_.has_number(id))
      refuse(text.at, "there is no mote with the id " + std::to_string(id));
    return motes_.by_number(id, text.at);
  }

  std::string_view text_;
  place_finder places_;
  pugi::xml_document document_;
  imported out_;
  mote_list motes_;
  note_list notes_;
  std::map<std::string, std::string> platforms_;
};

} // namespace

import_result read_cooja(std::string_view text) {
  return cooja_reader(text).read();
}

} // namespace rubicon::imports
