// Movements of motes as ns-2's setdest writes them, and ns-3's Ns2MobilityHelper reads them.
#include <algorithm>
#include <cmath>
#include <map>

#include "imports/readers.hpp"

namespace rubicon::imports {

namespace {

constexpr double trace_seconds_max = 1e7;

duration after_seconds(double x) {
  return std::chrono::milliseconds(std::llround(x * 1000));
}

/// One mote in motion: where it is at any time of the last command, and its corners so far.
struct walker {
  double since_s = 0; ///< it left `from`
  point from;
  point to;
  double arrives_s = 0;

  [[nodiscard]] point at(double t) const {
    if (t >= arrives_s)
      return to;
    const auto share = (t - since_s) / (arrives_s - since_s);
    return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m),
            from.z_m};
  }
};

class setdest_reader {
public:
  import_result read(std::string_view text) {
    line_fields lines(text, " \t\"");
    while (lines.next())
      take(lines);
    out_.plan.length =
        std::max(out_.plan.length,
                 duration(std::chrono::ceil<std::chrono::minutes>(after_seconds(last_s_))));
    for (const auto& [index, walk] : walkers_)
      corner(index, walk.arrives_s, walk.to);
    return finished(std::move(out_), motes_, notes_);
  }

private:
  void take(const line_fields& lines) {
    const auto& fields = lines.fields();
    if (fields.empty() || fields.front().text.starts_with('#'))
      return;
    if (fields.front().text.starts_with("$node_("))
      return set(lines);
    if (fields.front().text == "$ns_" && fields.size() > 2 && fields[1].text == "at")
      return command(lines);
    if (fields.front().text.starts_with("$god_"))
      return notes_.add(fields.front().at, "distances of `$god_`, which follow from the radio");
    if (fields.front().text == "set")
      return notes_.add(fields.front().at, "variables of Tcl");
    refuse(fields.front().at,
           "expected `$node_(N) set X_ NUMBER` or `$ns_ at TIME \"$node_(N) setdest X Y SPEED\"`, "
           "not " +
               quoted(fields.front().text));
  }

  std::size_t node(const field& x) {
    constexpr std::string_view begin = "$node_(";
    if (!x.text.starts_with(begin) || !x.text.ends_with(')'))
      refuse(x.at, "expected $node_(N), not " + quoted(x.text));
    const field number{x.text.substr(begin.size(), x.text.size() - begin.size() - 1),
                       {x.at.line, x.at.column + begin.size()}};
    return motes_.by_number(node_of(number), x.at);
  }

  static const field& need(const line_fields& lines, std::size_t i, const char* what) {
    if (i >= lines.fields().size())
      refuse(lines.end(), std::string(what) + " is missing");
    return lines.fields()[i];
  }

  void set(const line_fields& lines) {
    const auto index = node(lines.fields().front());
    if (need(lines, 1, "`set`").text != "set")
      refuse(lines.fields()[1].at, "expected `set`, not " + quoted(lines.fields()[1].text));
    const auto& axis = need(lines, 2, "X_, Y_ or Z_");
    auto& place = motes_.at(index).place;
    const auto value = coordinate_of(need(lines, 3, "a coordinate"), "a coordinate");
    if (axis.text == "X_")
      place.x_m = value;
    else if (axis.text == "Y_")
      place.y_m = value;
    else if (axis.text == "Z_")
      place.z_m = value;
    else
      refuse(axis.at, "expected X_, Y_ or Z_, not " + quoted(axis.text));
  }

  void command(const line_fields& lines) {
    const auto t = real_of(lines.fields()[2], "a time in seconds", 0, trace_seconds_max);
    const auto& who = need(lines, 3, "$node_(N)");
    if (who.text.starts_with("$god_"))
      return notes_.add(who.at, "distances of `$god_`, which follow from the radio");
    const auto index = node(who);
    const auto& what = need(lines, 4, "`setdest`");
    if (what.text == "set")
      return notes_.add(what.at, "jumps (`set` at a time)");
    if (what.text != "setdest")
      refuse(what.at, "expected `setdest`, not " + quoted(what.text));
    const point to{coordinate_of(need(lines, 5, "x"), "x"), coordinate_of(need(lines, 6, "y"), "y"),
                   motes_.at(index).place.z_m};
    const auto speed = real_of(need(lines, 7, "a speed"), "a speed in m/s", 0, 1000);
    go(index, t, to, speed, what.at);
  }

  void go(std::size_t index, double t, point to, double speed, text_place at) {
    const auto place = motes_.at(index).place;
    auto [found, is_new] = walkers_.try_emplace(index, walker{0, place, place, 0});
    auto& walk = found->second;
    if (t < walk.since_s)
      refuse(at, "it comes after a later command of the same node");
    const auto from = walk.at(t);
    if (!is_new)
      corner(index, std::min(walk.arrives_s, t), walk.at(std::min(walk.arrives_s, t)));
    corner(index, t, from);
    const auto distance = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    if (speed <= 0 || distance <= 0)
      to = from;
    const auto arrives = speed > 0 ? t + distance / speed : t;
    if (arrives > trace_seconds_max)
      refuse(at, "it would not arrive within 10000000 s");
    walk = {t, from, to, arrives};
    last_s_ = std::max(last_s_, arrives);
  }

  /// A time is not given twice: the later place counts.
  void corner(std::size_t index, double t, point where) {
    auto& path = motes_.at(index).path;
    const auto at = after_seconds(t);
    if (!path.empty() && at <= path.back().first)
      path.back().second = where;
    else if (path.size() == waypoints_max)
      notes_.add({}, "movements of a mote after its " + std::to_string(waypoints_max) + "th");
    else
      path.emplace_back(at, where);
  }

  imported out_;
  mote_list motes_;
  note_list notes_;
  std::map<std::size_t, walker> walkers_;
  double last_s_ = 0;
};

} // namespace

import_result read_setdest(std::string_view text) {
  return setdest_reader().read(text);
}

} // namespace rubicon::imports
