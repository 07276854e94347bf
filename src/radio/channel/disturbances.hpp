// Times in which copies of frames are lost besides, for the radios of an island or for all.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace rubicon::radio {

class disturbances {
public:
  /// @param pan whose radios lose copies by this chance; nothing: all
  /// @returns its name for end()
  std::uint32_t begin(std::optional<std::uint16_t> pan, double loss) {
    all_.push_back({++so_far_, pan, loss});
    return so_far_;
  }

  void end(std::uint32_t name) {
    std::erase_if(all_, [name](const auto& x) { return x.name == name; });
  }

  [[nodiscard]] bool empty() const { return all_.empty(); }

  /// The chance that a copy for a radio of this PAN is lost: several add up as chances do.
  [[nodiscard]] double loss_in(std::uint16_t pan) const {
    double arrives = 1;
    for (const auto& x : all_)
      arrives *= x.pan.value_or(pan) == pan ? 1 - x.loss : 1;
    return 1 - arrives;
  }

private:
  struct disturbance {
    std::uint32_t name = 0;
    std::optional<std::uint16_t> pan;
    double loss = 0;
  };

  std::vector<disturbance> all_;
  std::uint32_t so_far_ = 0;
};

} // namespace rubicon::radio
