#include "cli/manual/manual_commands.hpp"

#include <fstream>
#include <string>

#include "cli/manual/completion.hpp"
#include "cli/manual/key_text.hpp"
#include "cli/manual/manual_page.hpp"
#include "cli/options/parse_command_line.hpp"
#include "cli/print/console.hpp"
#include "cli/words/version.hpp"
#include "config/load.hpp"
#include "config/toml/schema.hpp"

namespace rubicon::cli {

exit_status perform(const explain_key_command& x) {
  const auto found = explain_key(config::describe_file(), x.key);
  if (!found.is_found)
    return refuse(found.text);
  return print(stdout, found.text) ? exit_status::good : exit_status::refused;
}

exit_status perform(const completion_command& x) {
  return print(stdout, completion_script(describe_commands(), x.shell)) ? exit_status::good
                                                                        : exit_status::refused;
}

exit_status perform(const pages_command& x) {
  const manual_edition edition{x.date, version};
  for (const auto& page : manual_pages(describe_commands(), config::describe_file(), edition)) {
    const auto path = x.folder + '/' + page.file;
    std::ofstream out(path, std::ios::binary);
    out << page.text;
    if (!out.flush())
      return refuse(path + " cannot be written");
  }
  return exit_status::good;
}

} // namespace rubicon::cli
