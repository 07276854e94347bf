// A shared library that is loaded while the program runs.
#pragma once

#include <string>

#include "core/bytes.hpp"

namespace rubicon::io {

/// A copy of its own, with variables of its own, however often the same octets are loaded. It is
/// written to a file for temporary files and loaded from there; the file is removed at once.
class shared_library {
public:
  /// @param name the beginning of its file's name
  /// @throws std::runtime_error if it cannot be written or loaded, with the loader's reason
  shared_library(const std::string& name, byte_view octets);
  ~shared_library();
  shared_library(const shared_library&) = delete;
  shared_library& operator=(const shared_library&) = delete;

  /// @returns nullptr if it does not export the name
  [[nodiscard]] const void* symbol(const char* name) const;

private:
  void* loaded_ = nullptr;
};

} // namespace rubicon::io
