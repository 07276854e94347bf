#include "io/process/shared_library.hpp"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <dlfcn.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

constexpr std::string_view library_suffix = ".so";

/// A file that goes with this object.
class passing_file {
public:
  explicit passing_file(const std::string& name) {
    path_ = (std::filesystem::temp_directory_path() / (name + "-XXXXXX")).string();
    path_ += library_suffix;
    descriptor_ = ::mkstemps(path_.data(), static_cast<int>(library_suffix.size()));
    if (descriptor_ < 0)
      throw std::system_error(errno, std::generic_category(), path_);
  }
  ~passing_file() {
    ::close(descriptor_);
    ::unlink(path_.c_str());
  }
  passing_file(const passing_file&) = delete;
  passing_file& operator=(const passing_file&) = delete;

  void write(byte_view octets) const {
    while (!octets.empty()) {
      const auto count = ::write(descriptor_, octets.data(), octets.size());
      if (count < 0 && errno == EINTR)
        continue;
      if (count < 0)
        throw std::system_error(errno, std::generic_category(), path_);
      octets = octets.subspan(static_cast<std::size_t>(count));
    }
  }

  [[nodiscard]] const std::string& path() const { return path_; }

private:
  std::string path_;
  int descriptor_ = -1;
};

} // namespace

shared_library::shared_library(const std::string& name, byte_view octets) {
  const passing_file file(name);
  file.write(octets);
  loaded_ = ::dlopen(file.path().c_str(), RTLD_NOW | RTLD_LOCAL);
  if (loaded_ == nullptr) {
    const char* reason = ::dlerror();
    throw std::runtime_error(reason != nullptr ? reason : "the library cannot be loaded");
  }
}

shared_library::~shared_library() {
  ::dlclose(loaded_);
}

const void* shared_library::symbol(const char* name) const {
  return ::dlsym(loaded_, name);
}

} // namespace rubicon::io
