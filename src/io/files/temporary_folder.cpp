#include "io/files/temporary_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "io/process/group_guard.hpp"

namespace rubicon::io {

temporary_folder::temporary_folder(const std::string& name) {
  auto path = (std::filesystem::temp_directory_path() / (name + "-XXXXXX")).string();
  if (::mkdtemp(path.data()) == nullptr)
    throw std::system_error(errno, std::generic_category(), path);
  path_ = path;
  group_guard::instance().add_folder(path);
}

temporary_folder::~temporary_folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  group_guard::instance().remove_folder(path_.string());
}

} // namespace rubicon::io
