// Where everybody is, and how well they reach their sinks.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "page/axis.hpp"
#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::page {

namespace {

using label_kind = config::label_table::kind;

constexpr double width_alone = 1000;
constexpr double width_beside = 540; ///< others
constexpr double margin = 46;
constexpr std::size_t labelled_max = 70; ///< motes of one map
constexpr std::size_t maps_shown_max = 24;

std::string_view words_of(std::string_view look) {
  return look == "good"   ? "99 % and more"
         : look == "fair" ? "95 % and more"
         : look == "poor" ? "80 % and more"
         : look == "bad"  ? "below 80 %"
                          : "nothing sent";
}

/// Where it is when the run ends.
position place_of(const config::mote_description& x, duration at) {
  auto place = x.place;
  for (std::size_t i = 0; i < x.path.size(); ++i) {
    const auto& next = x.path[i];
    if (next.at <= at) {
      place = next.place;
      continue;
    }
    if (i == 0)
      break;
    const auto& last = x.path[i - 1];
    const auto fraction = seconds(at - last.at) / seconds(next.at - last.at);
    return {last.place.x_m + fraction * (next.place.x_m - last.place.x_m),
            last.place.y_m + fraction * (next.place.y_m - last.place.y_m), place.z_m};
  }
  return place;
}

/// A rectangle that a label takes.
struct box {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;

  [[nodiscard]] bool meets(const box& x) const {
    return left < x.right && x.left < right && top < x.bottom && x.top < bottom;
  }
};

/// The map of one air.
class air_map {
public:
  air_map(const run_page& page, const config::air_description& air, double width)
      : page_(page), width_(width), has_matrix_(has_matrix(page)) {
    for (const auto& island : page.ecology.islands) {
      if (std::ranges::find(air.islands, island.id) == air.islands.end())
        continue;
      islands_.push_back(&island);
      reach(island.sink.place);
      for (const auto& mote : island.motes) {
        reach(place_of(mote, page.report.simulated));
        for (const auto& each : mote.path)
          reach(each.place);
        ++motes_;
      }
    }
    fit();
  }

  [[nodiscard]] bool empty() const { return islands_.empty(); }

  std::string draw(std::string_view label) {
    drawing out(width_, height_,
                "class='map' role='img' aria-label='" + escaped("Map of " + std::string(label)) +
                    '\'');
    out.rect({0.5, 0.5}, width_ - 1, height_ - 1, "class='frame' rx='4'");
    for (const auto* island : islands_)
      draw_links(out, *island);
    for (const auto* island : islands_)
      draw_nodes(out, *island);
    for (const auto* island : islands_)
      draw_labels(out, *island);
    draw_scale(out);
    return out.finish();
  }

private:
  void reach(const position& x) {
    low_ = {std::min(low_.x, x.x_m), std::min(low_.y, x.y_m)};
    high_ = {std::max(high_.x, x.x_m), std::max(high_.y, x.y_m)};
  }

  void fit() {
    const auto wide_m = std::max(high_.x - low_.x, 0.0);
    const auto high_m = std::max(high_.y - low_.y, 0.0);
    constexpr double height_max = 620;
    scale_ = std::min((width_ - 2 * margin) / std::max(wide_m, 1e-3),
                      (height_max - 2 * margin) / std::max(high_m, 1e-3));
    if (wide_m <= 0 && high_m <= 0)
      scale_ = 40;
    height_ = std::max(high_m * scale_ + 2 * margin, 130.0);
    left_ = (width_ - wide_m * scale_) / 2;
    radius_ = motes_ <= labelled_max ? 6 : motes_ <= 250 ? 4 : 2.5;
  }

  /// North is up.
  [[nodiscard]] point at(const position& x) const {
    return {left_ + (x.x_m - low_.x) * scale_,
            (height_ - (high_.y - low_.y) * scale_) / 2 + (high_.y - x.y_m) * scale_};
  }

  [[nodiscard]] const report::island_report* report_of(island_id x) const {
    const auto& all = page_.report.islands;
    const auto found = std::ranges::find(all, x, &report::island_report::id);
    return found == all.end() ? nullptr : &*found;
  }

  [[nodiscard]] const report::mote_report* report_of(island_id island, mote_id mote) const {
    const auto* const all = report_of(island);
    if (all == nullptr)
      return nullptr;
    const auto found =
        std::ranges::find(all->motes, mote_address{island, mote}, &report::mote_report::address);
    return found == all->motes.end() ? nullptr : &*found;
  }

  [[nodiscard]] std::map<mote_id, point> places_of(const config::island_description& x) const {
    std::map<mote_id, point> all{{x.sink.id, at(x.sink.place)}};
    for (const auto& mote : x.motes)
      all[mote.id] = at(place_of(mote, page_.report.simulated));
    return all;
  }

  void draw_links(drawing& out, const config::island_description& island) const {
    const auto places = places_of(island);
    for (const auto& mote : island.motes) {
      if (mote.path.size() > 1) {
        std::vector<point> path;
        for (const auto& each : mote.path)
          path.push_back(at(each.place));
        out.polyline(path, "class='path'");
      }
      const auto* const own = report_of(island.id, mote.id);
      if (own == nullptr || !places.contains(own->parent))
        continue;
      const auto delivery = own->messages.delivery();
      const auto look = class_of(delivery);
      out.line(places.at(mote.id), places.at(own->parent),
               "class='link " + std::string(look) + '\'',
               named(page_, label_kind::mote, island.name + '/' + mote.name) + ": " +
                   share(delivery) + " of its messages arrived");
    }
    for (const auto& flow : page_.report.flows) {
      const bool is_here = !has_matrix_ && flow.from.island == island.id &&
                           flow.to.island == island.id && places.contains(flow.from.mote) &&
                           places.contains(flow.to.mote);
      if (!is_here || flow.sent == 0)
        continue;
      out.line(places.at(flow.from.mote), places.at(flow.to.mote),
               "class='link " + std::string(class_of(flow.pdr)) + '\'',
               flow.from_name + " to " + flow.to_name + ": " + share(flow.pdr) + " delivered");
    }
  }

  void draw_nodes(drawing& out, const config::island_description& island) {
    for (const auto& mote : island.motes) {
      const auto* const own = report_of(island.id, mote.id);
      const auto where = at(place_of(mote, page_.report.simulated));
      const bool absent = own != nullptr && own->joins && !own->joined;
      const auto title = title_of(island, mote, own);
      out.circle(where, radius_, absent ? "class='mote absent'" : "class='mote'", title);
      if (own != nullptr && !own->alive) {
        const auto arm = radius_ + 3;
        out.line({where.x - arm, where.y - arm}, {where.x + arm, where.y + arm}, "class='dead'",
                 title);
        out.line({where.x - arm, where.y + arm}, {where.x + arm, where.y - arm}, "class='dead'",
                 title);
      }
      taken_.push_back(around(where, radius_ + 1));
    }
    const auto sink = at(island.sink.place);
    const auto half = radius_ + 2.5;
    out.rect({sink.x - half, sink.y - half}, 2 * half, 2 * half, "class='sink'",
             named(page_, label_kind::island, island.name) + "/sink");
    taken_.push_back(around(sink, half));
  }

  [[nodiscard]] std::string title_of(const config::island_description& island,
                                     const config::mote_description& mote,
                                     const report::mote_report* own) const {
    auto text = named(page_, label_kind::mote, island.name + '/' + mote.name);
    if (own == nullptr)
      return text;
    if (own->joins && !own->joined)
      text += ", never joined";
    if (!own->alive)
      text += own->left_cause.empty() ? ", off" : ", " + own->left_cause;
    if (own->messages.offered > 0)
      text += ", " + report::counted(own->messages.offered, "message") + ", " +
              share(own->messages.delivery()) + " arrived";
    return text;
  }

  [[nodiscard]] static box around(point x, double half) {
    return {x.x - half, x.y - half, x.x + half, x.y + half};
  }

  /// Beside what it names, where there is room; else nowhere: the title has it.
  /// @returns whether there was room
  bool label(drawing& out, point x, const std::string& text, std::string_view look) {
    // of the font's most common letters
    const auto wide = 8.4 * static_cast<double>(report::display_width(text));
    const auto gap = radius_ + 4;
    struct choice {
      point at;
      double left;
      const char* anchor;
    };
    const choice choices[] = {{{x.x + gap, x.y + 4}, x.x + gap, "start"},
                              {{x.x - gap, x.y + 4}, x.x - gap - wide, "end"},
                              {{x.x, x.y - gap}, x.x - wide / 2, "middle"},
                              {{x.x, x.y + gap + 11}, x.x - wide / 2, "middle"}};
    for (const auto& each : choices) {
      const box room{each.left, each.at.y - 13, each.left + wide, each.at.y + 4};
      const bool fits = room.left >= 3 && room.right <= width_ - 3 && room.top >= 3 &&
                        room.bottom <= height_ - 3 &&
                        std::ranges::none_of(taken_, [&](const box& y) { return room.meets(y); });
      if (!fits)
        continue;
      out.text(each.at, "class='" + std::string(look) + "' text-anchor='" + each.anchor + '\'',
               text);
      taken_.push_back(room);
      return true;
    }
    return false;
  }

  void draw_labels(drawing& out, const config::island_description& island) {
    const auto sink = at(island.sink.place);
    const auto name = named(page_, label_kind::island, island.name);
    if (!label(out, sink, name, "strong") && name != island.name)
      label(out, sink, island.name, "strong");
    if (motes_ > labelled_max)
      return;
    for (const auto& mote : island.motes) {
      const auto place = at(place_of(mote, page_.report.simulated));
      const auto called = page_.ecology.labels.of(label_kind::mote, island.name + '/' + mote.name);
      if (called.empty() || !label(out, place, mote.name + " (" + called + ')', "soft"))
        (void)label(out, place, mote.name, "soft");
    }
  }

  void draw_scale(drawing& out) const {
    const auto round = ticks(0, 160 / scale_, 2);
    if (round.size() < 2)
      return;
    const auto length = round[1].value * scale_;
    const point left{14, height_ - 14};
    out.line(left, {left.x + length, left.y}, "stroke='currentColor' stroke-width='2'");
    out.text({left.x, left.y - 6}, "class='soft'", round[1].label + " m");
  }

  const run_page& page_;
  double width_;
  bool has_matrix_; ///< flows are in the matrix
  std::vector<const config::island_description*> islands_;
  std::size_t motes_ = 0;
  point low_{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  point high_{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
  double scale_ = 1;
  double height_ = 0;
  double left_ = 0;
  double radius_ = 6;
  std::vector<box> taken_;
};

std::string legend() {
  std::string out = "<div class='legend'>";
  const auto entry = [&out](const std::string& what, std::string_view text) {
    drawing sample(34, 14, "aria-hidden='true'");
    out += "<span>";
    if (what == "sink")
      sample.rect({11, 1}, 12, 12, "class='sink'");
    else if (what == "mote" || what == "mote absent" || what == "dead")
      sample.circle({17, 7}, 5.5, "class='" + (what == "dead" ? "mote" : what) + '\'');
    else
      sample.line({1, 7}, {33, 7}, "class='link " + what + '\'');
    if (what == "dead") {
      sample.line({10, 0}, {24, 14}, "class='dead'");
      sample.line({10, 14}, {24, 0}, "class='dead'");
    }
    out += sample.finish() + escaped(text) + "</span>\n";
  };
  entry("sink", "sink");
  entry("mote", "mote");
  entry("mote absent", "never joined");
  entry("dead", "without power at the end");
  for (const auto* look : {"good", "fair", "poor", "bad", "unknown"})
    entry(look, "to its parent: " + std::string(words_of(look)));
  return out + "</div>\n";
}

} // namespace

std::string map_of(const run_page& x) {
  std::string maps;
  std::size_t count = 0;
  const auto& airs = x.ecology.airs;
  const bool single = airs.size() == 1;
  for (const auto& air : airs) {
    air_map map(x, air, single ? width_alone : width_beside);
    if (map.empty() || count++ >= maps_shown_max)
      continue;
    std::string names;
    for (const auto& island : x.ecology.islands)
      if (std::ranges::find(air.islands, island.id) != air.islands.end())
        names += (names.empty() ? "" : ", ") + named(x, label_kind::island, island.name);
    maps += "<figure>" + map.draw(names) + element("figcaption", names) + "</figure>\n";
  }
  if (maps.empty())
    return {};
  if (count > maps_shown_max)
    maps += element("p", "… and " + report::counted(count - maps_shown_max, "more place"),
                    "class='soft'");
  const auto shown = single ? wide(maps) : "<div class='grid'>" + maps + "</div>\n";
  return section("map", "Map", shown + legend());
}

} // namespace rubicon::page
