// A folder for files that nobody needs later.
#pragma once

#include <filesystem>
#include <string>

namespace rubicon::io {

/// For its owner only, and gone with this object, also if the process is killed before.
class temporary_folder {
public:
  /// @param name the beginning of its name
  /// @throws std::system_error if there is no room for it
  explicit temporary_folder(const std::string& name);
  ~temporary_folder();
  temporary_folder(const temporary_folder&) = delete;
  temporary_folder& operator=(const temporary_folder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

} // namespace rubicon::io
