#include "cli/print/new_file.hpp"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

namespace rubicon::cli {

std::string write_new_file(const std::string& path, std::string_view text, bool replaces) {
  struct closer {
    void operator()(std::FILE* x) const { static_cast<void>(std::fclose(x)); }
  };
  const auto reason = [&path] { return path + ": " + std::generic_category().message(errno); };
  std::unique_ptr<std::FILE, closer> file(std::fopen(path.c_str(), replaces ? "w" : "wx"));
  if (!file)
    return errno == EEXIST ? path + " exists already; --force overwrites it" : reason();
  const bool written = std::fwrite(text.data(), 1, text.size(), file.get()) == text.size();
  if (std::fflush(file.get()) != 0 || !written)
    return reason();
  return {};
}

} // namespace rubicon::cli
