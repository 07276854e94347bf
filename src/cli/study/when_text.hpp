// What `rubicon explain --when` prints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "explain/print/text.hpp"
#include "explain/traces.hpp"
#include "report/report.hpp"
#include "study/turning_point.hpp"

namespace rubicon::cli {

struct when_answer {
  report::violation what;
  std::size_t futures = 0; ///< that each time was judged by
  study::turning_point found;
  std::vector<std::string> words; ///< of the run, after `rubicon run`
};

/// `299950ms:2`, as of `run --reseed`.
[[nodiscard]] std::string reseed_text(duration at, std::uint64_t key);

[[nodiscard]] std::string when_text(const when_answer& x, const explain::traces& all,
                                    const explain::text_style& style);
[[nodiscard]] std::string when_json(const when_answer& x, const explain::traces& all);

} // namespace rubicon::cli
