// The frame of a question or an answer: a header of 12 octets, and the content.
//
//   'R' 'u' | 1, version of this layout | kind | number (4) | octets that follow (4)
//
// in network byte order. `kind` is the index in deploy::question or deploy::answer, and an answer
// has the number of its question.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/bytes.hpp"
#include "deploy/messages.hpp"

namespace rubicon::control {

inline constexpr std::size_t frame_header_octets = 12;

struct frame {
  std::uint8_t kind = 0;
  std::uint32_t number = 0;
  bytes content;
};

/// @pre the content is shorter than 4 GiB
[[nodiscard]] bytes encode_header(const frame& x);

/// The longest content of each kind.
using frame_limits = std::span<const std::size_t>;

[[nodiscard]] frame_limits question_limits();
[[nodiscard]] frame_limits answer_limits();

/// Only frames with files or reports may announce more octets than this.
inline constexpr std::size_t small_octets_max = std::size_t{1} << 20;

/// Puts one frame together.
///
///   header --12 octets, within the limits--> content --all--> complete --take()--> header
///      |                                        |
///      +---- anything else: refused <-----------+
class frame_reader {
public:
  enum class state : std::uint8_t { header, content, complete, refused };

  explicit frame_reader(frame_limits limits) : limits_(limits) {}

  /// Takes what belongs to the frame: nothing once it is complete or refused. Memory grows with
  /// what comes, not with what is announced.
  /// @returns how many octets it has taken
  std::size_t feed(byte_view octets);

  [[nodiscard]] state now() const { return state_; }

  /// Octets of the content that are announced; 0 while the header is not complete.
  [[nodiscard]] std::size_t announced() const { return announced_; }

  /// Why the header is none. @pre refused
  [[nodiscard]] const std::string& problem() const { return problem_; }

  /// The frame; the next one may come. @pre complete
  [[nodiscard]] frame take();

private:
  void read_header();
  void refuse(std::string why);

  frame_limits limits_;
  state state_ = state::header;
  std::size_t header_octets_ = 0;
  std::array<std::uint8_t, frame_header_octets> header_{};
  std::size_t announced_ = 0;
  frame frame_;
  std::string problem_;
};

} // namespace rubicon::control
