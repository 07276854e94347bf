// The smallest file with which something still happens: parts of it are left out, more at once at
// first, as long as what is tried confirms it (delta debugging, Zeller and Hildebrandt 2002).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "study/outline.hpp"

namespace rubicon::study {

/// What is still there of what there was.
struct kept {
  std::size_t of = 0;
  std::size_t left = 0;
};

/// Alternates between next() and take(). Faults come first, then motes, programs, peers, other
/// tables, the length of the run, entries, elements of arrays, and the digits of numbers; again
/// from the start until nothing more can be left out.
class shrinker {
public:
  static constexpr std::size_t tries_max = 5000;

  /// @param length_s of the run, in whole seconds rounded up; 0: it stays as it is
  /// @param seen_s   when it happened, likewise
  explicit shrinker(std::string text, std::uint64_t length_s = 0, std::uint64_t seen_s = 0);

  /// A smaller file to try; nothing: there is none.
  [[nodiscard]] std::optional<std::string> next();

  /// Whether it still happens with what next() has returned.
  void take(bool happens);

  [[nodiscard]] std::string smallest() const { return text_of(now_); }
  [[nodiscard]] std::size_t tries() const { return tries_; }

  [[nodiscard]] kept faults() const { return count(pass::faults); }
  [[nodiscard]] kept motes() const { return count(pass::motes); }
  [[nodiscard]] kept peers() const { return count(pass::peers); }

private:
  enum class pass : std::uint8_t {
    faults,
    motes,
    programs,
    peers,
    tables,
    length,
    entries,
    elements,
    digits,
    ended
  };

  /// A version of the file.
  struct version {
    std::vector<bool> is_out;                  ///< by piece
    std::map<std::size_t, std::string> values; ///< of entries, in the place of their own
    std::uint64_t length_s = 0;

    friend bool operator==(const version&, const version&) = default;
  };

  [[nodiscard]] static bool belongs(const piece& x, pass to);
  [[nodiscard]] kept count(pass of) const;
  [[nodiscard]] bool is_out(const version& x, std::size_t piece) const;
  [[nodiscard]] std::string text_of(const version& x) const;
  void begin(pass x);
  void begin_next();
  [[nodiscard]] std::optional<version> next_length();
  [[nodiscard]] std::optional<version> next_removal();
  [[nodiscard]] std::optional<version> next_digits();

  std::string text_;
  std::vector<piece> pieces_;
  std::optional<std::size_t> length_entry_;
  std::uint64_t seen_s_;
  version now_;
  version tried_;
  version at_round_; ///< when this round began
  pass pass_ = pass::faults;
  std::vector<std::size_t> list_; ///< pieces of this pass
  std::size_t size_ = 0;          ///< of them are left out at once
  std::size_t place_ = 0;
  std::uint64_t too_short_s_ = 0; ///< a run of that length did not have it
  std::size_t tries_ = 0;
};

} // namespace rubicon::study
