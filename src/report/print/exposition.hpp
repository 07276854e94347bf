// Samples as Prometheus reads them: text format 0.0.4.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rubicon::report {

/// Names and values of what a sample is of; values may be any text.
using metric_labels = std::vector<std::pair<std::string_view, std::string>>;

/// `counter` may only grow while its source lives; `gauge` may do anything.
enum class metric_kind : bool { counter, gauge };

/// Families of samples, in the order of their first ones: the samples of a family stand together.
class exposition {
public:
  static constexpr const char* content_type = "text/plain; version=0.0.4; charset=utf-8";

  /// @param name of the family: letters, digits, `_`; of a counter it ends in `_total`
  /// @param help one line that says what it is
  void add(const std::string& name, metric_kind kind, std::string_view help,
           const metric_labels& labels, double value);

  /// All of them, once.
  [[nodiscard]] std::string finish();

private:
  std::map<std::string, std::size_t> places_; ///< of families, by name
  std::vector<std::string> families_;         ///< the lines of each
};

} // namespace rubicon::report
