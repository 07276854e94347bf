#include "smepp_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <string>

namespace bench {

namespace {

constexpr double width = 860;
constexpr double height = 400;
constexpr double top = 70;
constexpr double bottom = 330;
constexpr const char* style =
    "text{font:12px sans-serif;fill:#222}.title{font:bold 14px sans-serif}.grid{stroke:#ddd}"
    ".axis{stroke:#666}.on{fill:#0072B2;stroke:#0072B2}.off{fill:#D55E00;stroke:#D55E00}"
    ".curve{fill:none;stroke-width:2}.inactive{fill:#d9d9d9}.ready{fill:#56B4E9}"
    ".receiving{fill:#009E73}.sending{fill:#CC79A7}.background{fill:#fff}";

std::string px(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", x);
  return text.data();
}

std::string fixed(double x, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, x);
  return text.data();
}

void text(std::ostream& out, double x, double y, const std::string& what,
          const std::string& attributes = "text-anchor='middle'") {
  out << "<text x='" << px(x) << "' y='" << px(y) << "' " << attributes << '>' << what
      << "</text>\n";
}

void draw_charge(std::ostream& out, const std::vector<smepp_row>& rows) {
  constexpr double left = 70;
  constexpr double right = 400;
  // Five steps of a whole number of 0.05 mAh.
  const double step = 0.05 * std::ceil(std::ranges::max(rows, {}, &smepp_row::mah).mah / 5 / 0.05);
  const double most = 5.5 * step;
  const auto y = [&](double mah) { return bottom - mah / most * (bottom - top); };
  const auto x = [&](double n) { return left + 20 + n / 4 * (right - left - 40); };
  text(out, (left + right) / 2, 40, "Charge used by s2 in 180 s, in mAh",
       "class='title' text-anchor='middle'");
  for (int i = 0; i <= 5; ++i) {
    const auto value = step * i;
    out << "<line class='grid' x1='" << px(left) << "' x2='" << px(right) << "' y1='"
        << px(y(value)) << "' y2='" << px(y(value)) << "'/>\n";
    text(out, left - 8, y(value) + 4, fixed(value, 2), "text-anchor='end'");
  }
  for (const bool saves : {false, true}) {
    const std::string kind = saves ? "on" : "off";
    std::string points;
    for (const auto& each : rows)
      if (each.saves == saves) {
        points += px(x(each.subscriptions)) + ',' + px(y(each.mah)) + ' ';
        if (saves)
          out << "<circle class='on' cx='" << px(x(each.subscriptions)) << "' cy='"
              << px(y(each.mah)) << "' r='4'/>\n";
        else
          out << "<rect class='off' x='" << px(x(each.subscriptions) - 4) << "' y='"
              << px(y(each.mah) - 4) << "' width='8' height='8'/>\n";
      }
    out << "<polyline class='curve " << kind << "' style='fill:none' points='" << points << "'/>\n";
    const auto last = std::ranges::find_if(
        rows, [&](const auto& each) { return each.saves == saves && each.subscriptions == 4; });
    text(out, right - 20, y(last->mah) - 12, "energy efficiency " + kind, "text-anchor='end'");
  }
  for (int n = 0; n <= 4; ++n)
    text(out, x(n), bottom + 18, std::to_string(n));
  text(out, (left + right) / 2, bottom + 38, "subscriptions");
}

void draw_states(std::ostream& out, const std::vector<smepp_row>& rows) {
  constexpr double left = 480;
  constexpr double right = 840;
  constexpr double bar = 26;
  text(out, (left + right) / 2, 40, "Radio of s2, share of the time",
       "class='title' text-anchor='middle'");
  for (int i = 0; i <= 4; ++i) {
    const auto y = bottom - (bottom - top) * i / 4;
    out << "<line class='grid' x1='" << px(left) << "' x2='" << px(right) << "' y1='" << px(y)
        << "' y2='" << px(y) << "'/>\n";
    text(out, left - 8, y + 4, std::to_string(25 * i) + " %", "text-anchor='end'");
  }
  double x = left + 10;
  for (const auto& each : rows) {
    if (!each.saves && each.subscriptions == 0)
      x += 12;
    double from = bottom;
    const auto part = [&](double share, const char* kind) {
      const auto size = share * (bottom - top);
      from -= size;
      out << "<rect class='" << kind << "' x='" << px(x) << "' y='" << px(from) << "' width='"
          << px(bar) << "' height='" << px(size) << "'/>\n";
    };
    part(each.sending, "sending");
    part(each.receiving, "receiving");
    part(each.ready, "ready");
    part(each.inactive, "inactive");
    text(out, x + bar / 2, bottom + 18, std::to_string(each.subscriptions));
    x += bar + 7;
  }
  text(out, left + 90, bottom + 38, "on, subscriptions");
  text(out, left + 268, bottom + 38, "off, subscriptions");
  double key = left;
  for (const char* kind : {"inactive", "ready", "receiving", "sending"}) {
    out << "<rect class='" << kind << "' x='" << px(key) << "' y='" << px(bottom + 48)
        << "' width='12' height='12'/>\n";
    text(out, key + 16, bottom + 58, kind, "text-anchor='start'");
    key += 90;
  }
}

} // namespace

void draw_smepp(std::ostream& out, const std::vector<smepp_row>& rows) {
  out << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 " << width << ' ' << height
      << "'>\n<style>" << style << "</style>\n<rect class='background' width='" << width
      << "' height='" << height << "'/>\n";
  draw_charge(out, rows);
  draw_states(out, rows);
  out << "</svg>\n";
}

void draw_key_changes(std::ostream& out, const std::vector<key_change_row>& rows) {
  out << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 " << width << ' ' << height
      << "'>\n<style>" << style << "</style>\n<rect class='background' width='" << width
      << "' height='" << height << "'/>\n";
  struct panel {
    const char* title;
    double key_change_row::*what;
    double left;
    int digits;
    const char* kind;
  };
  const double members_max = rows.back().members;
  for (const auto& each :
       {panel{"Frames of a change of keys", &key_change_row::frames, 70, 0, "on"},
        panel{"Charge of a change of keys, in mAh", &key_change_row::mah, 510, 3, "off"}}) {
    const double right = each.left + 330;
    const double most = 1.1 * std::ranges::max(rows, {}, each.what).*each.what;
    const auto x = [&](double n) { return each.left + n / members_max * (right - each.left - 10); };
    const auto y = [&](double value) { return bottom - value / most * (bottom - top); };
    text(out, (each.left + right) / 2, 40, each.title, "class='title' text-anchor='middle'");
    for (int i = 0; i <= 4; ++i) {
      const auto value = most / 1.1 * i / 4;
      out << "<line class='grid' x1='" << px(each.left) << "' x2='" << px(right) << "' y1='"
          << px(y(value)) << "' y2='" << px(y(value)) << "'/>\n";
      text(out, each.left - 8, y(value) + 4, fixed(value, each.digits), "text-anchor='end'");
    }
    std::string points;
    for (const auto& row : rows) {
      points += px(x(row.members)) + ',' + px(y(row.*each.what)) + ' ';
      out << "<circle class='" << each.kind << "' cx='" << px(x(row.members)) << "' cy='"
          << px(y(row.*each.what)) << "' r='4'/>\n";
      text(out, x(row.members), bottom + 18, std::to_string(row.members));
    }
    out << "<polyline class='curve " << each.kind << "' style='fill:none' points='" << points
        << "'/>\n";
    text(out, (each.left + right) / 2, bottom + 38, "members, of which one leaves");
  }
  out << "</svg>\n";
}

} // namespace bench
