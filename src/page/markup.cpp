#include "page/markup.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "core/text/printable.hpp"

namespace rubicon::page {

namespace {

std::string places_of(const std::vector<point>& points) {
  std::string text = "points='";
  for (const auto& x : points)
    text.append(px(x.x)).append(",").append(px(x.y)).append(" ");
  if (!points.empty())
    text.pop_back();
  return text + '\'';
}

} // namespace

std::string escaped(std::string_view x) {
  std::string text;
  for (const char c : printable(x)) {
    switch (c) {
    case '&':
      text += "&amp;";
      break;
    case '<':
      text += "&lt;";
      break;
    case '>':
      text += "&gt;";
      break;
    case '"':
      text += "&quot;";
      break;
    case '\'':
      text += "&#39;";
      break;
    default:
      text += c;
    }
  }
  return text;
}

std::string element(std::string_view tag, std::string_view text, std::string_view attributes) {
  std::string out = "<";
  out.append(tag);
  if (!attributes.empty())
    out.append(" ").append(attributes);
  return out.append(">").append(escaped(text)).append("</").append(tag).append(">");
}

std::string px(double x) {
  if (!std::isfinite(x))
    return "-";
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.1f", x);
  return text.data();
}

drawing::drawing(double width, double height, std::string_view attributes) {
  svg_ = "<svg ";
  svg_.append(attributes).append(" viewBox='0 0 " + px(width) + ' ' + px(height) + "'>\n");
}

void drawing::shape(std::string_view tag, std::string_view places, std::string_view attributes,
                    std::string_view title) {
  svg_.append("<").append(tag).append(" ").append(places).append(" ").append(attributes);
  if (title.empty())
    svg_ += "/>\n";
  else
    svg_.append(">").append(page::element("title", title)).append("</").append(tag).append(">\n");
}

void drawing::line(point from, point to, std::string_view attributes, std::string_view title) {
  shape("line",
        "x1='" + px(from.x) + "' y1='" + px(from.y) + "' x2='" + px(to.x) + "' y2='" + px(to.y) +
            '\'',
        attributes, title);
}

void drawing::polyline(const std::vector<point>& points, std::string_view attributes) {
  shape("polyline", places_of(points), attributes, {});
}

void drawing::polygon(const std::vector<point>& points, std::string_view attributes,
                      std::string_view title) {
  shape("polygon", places_of(points), attributes, title);
}

void drawing::rect(point corner, double width, double height, std::string_view attributes,
                   std::string_view title) {
  shape("rect",
        "x='" + px(corner.x) + "' y='" + px(corner.y) + "' width='" + px(width) + "' height='" +
            px(height) + '\'',
        attributes, title);
}

void drawing::circle(point middle, double radius, std::string_view attributes,
                     std::string_view title) {
  shape("circle", "cx='" + px(middle.x) + "' cy='" + px(middle.y) + "' r='" + px(radius) + '\'',
        attributes, title);
}

void drawing::text(point at, std::string_view attributes, std::string_view what,
                   std::string_view title) {
  auto words = page::element(
      "text", what, "x='" + px(at.x) + "' y='" + px(at.y) + "' " + std::string(attributes));
  if (!title.empty())
    words.insert(words.rfind("</"), page::element("title", title));
  svg_ += words + '\n';
}

} // namespace rubicon::page
