#include "cli/schema_command.hpp"

#include "cli/print/console.hpp"
#include "config/load.hpp"
#include "config/toml/document.hpp"
#include "config/toml/schema.hpp"
#include "core/text/printable.hpp"

namespace rubicon::cli {

exit_status perform(const schema_command& x) {
  const auto all = config::describe_file();
  if (x.tables_of.empty())
    return print(stdout, config::json_schema(all)) ? exit_status::good : exit_status::refused;
  const auto document = config::read_file(x.tables_of, config::file_octets_max);
  if (!document.text) {
    static_cast<void>(print(stderr, printable(x.tables_of + ": " + document.reason) + '\n'));
    return exit_status::refused;
  }
  return print(stdout, config::with_tables(all, *document.text)) ? exit_status::good
                                                                 : exit_status::refused;
}

} // namespace rubicon::cli
