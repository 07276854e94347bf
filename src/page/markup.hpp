// HTML and SVG as text: what of others stands in it is data, never markup.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rubicon::page {

/// Text as elements and quoted attributes may hold it: all of it is seen, and nothing of it acts.
[[nodiscard]] std::string escaped(std::string_view x);

/// `<td class='number'>12</td>`. @param text is escaped; tag and attributes are ours
[[nodiscard]] std::string element(std::string_view tag, std::string_view text,
                                  std::string_view attributes = {});

/// A length or place in a drawing, with a decimal; not finite: `-`.
[[nodiscard]] std::string px(double x);

/// A place in a drawing; y grows downwards.
struct point {
  double x = 0;
  double y = 0;
};

/// An SVG drawing. Attributes are ours, in single quotes; texts and titles are escaped.
class drawing {
public:
  /// @param attributes of the element `svg`, beside its `viewBox`
  drawing(double width, double height, std::string_view attributes);

  void line(point from, point to, std::string_view attributes, std::string_view title = {});
  void polyline(const std::vector<point>& points, std::string_view attributes);
  /// A polyline whose inside is filled.
  void polygon(const std::vector<point>& points, std::string_view attributes,
               std::string_view title = {});
  void rect(point corner, double width, double height, std::string_view attributes,
            std::string_view title = {});
  void circle(point middle, double radius, std::string_view attributes,
              std::string_view title = {});
  /// @param title what it says in full, if `what` is cut
  void text(point at, std::string_view attributes, std::string_view what,
            std::string_view title = {});

  void element(std::string_view tag, std::string_view text) { svg_ += page::element(tag, text); }

  [[nodiscard]] std::string finish() { return std::move(svg_) + "</svg>\n"; }

private:
  void shape(std::string_view tag, std::string_view places, std::string_view attributes,
             std::string_view title);

  std::string svg_;
};

} // namespace rubicon::page
