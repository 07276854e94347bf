// Lines between this process and the one that has started it, over a Unix socket.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace rubicon::io {

/// One end, which connects. It waits for the other end to read and to write: nothing else happens
/// meanwhile.
class line_socket {
public:
  /// @returns why there is none
  [[nodiscard]] static std::variant<line_socket, std::string> connect(const std::string& path);

  line_socket(line_socket&& x) noexcept;
  line_socket& operator=(line_socket&&) = delete;
  ~line_socket();

  /// The next line, without its end. Nothing: the other end is closed, or the line is longer.
  [[nodiscard]] std::optional<std::string> read(std::size_t octets_max);

  /// Adds the end of the line. @returns false: the other end is closed
  [[nodiscard]] bool write(std::string line);

  /// Whether the other end is closed; does not wait.
  [[nodiscard]] bool is_closed() const;

private:
  explicit line_socket(int descriptor) : descriptor_(descriptor) {}

  int descriptor_;
  std::string received_;
};

} // namespace rubicon::io
