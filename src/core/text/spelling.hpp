// What somebody probably meant who mistyped a name.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rubicon {

/// How many characters must be inserted, removed, replaced or swapped with their neighbour to make
/// `b` of `a`; letter case does not count.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The nearest of `known` if it is near enough to be meant, of equally near ones the first; else
/// empty, as it is when more than 2000 are known.
[[nodiscard]] std::string nearest(std::string_view word, const std::vector<std::string>& known);

/// Ends a complaint about a name that does not exist: `: did you mean `x`?`, or else what there is,
/// at most ten; `: there is none` for none.
[[nodiscard]] std::string suggestion(std::string_view word, const std::vector<std::string>& known);

} // namespace rubicon
