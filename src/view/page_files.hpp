// The files of the live page (src/view/page), as they are in the binary.
#pragma once

#include <string_view>

namespace rubicon::view {

[[nodiscard]] std::string_view page_html();
[[nodiscard]] std::string_view page_css();
[[nodiscard]] std::string_view page_js();

} // namespace rubicon::view
