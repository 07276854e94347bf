// Replays a corpus, and seeded mutations of it, through one of the fuzz targets, all of which are
// in this program: they run without libFuzzer, which explores further under the fuzz preset.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include "core/bytes.hpp"
#include "core/numbers/random.hpp"

// tests/CMakeLists.txt lists the targets, and names the LLVMFuzzerTestOneInput of each after it.
#define FUZZ_TARGET(name) extern "C" int fuzz_##name(const std::uint8_t* data, std::size_t size);
#include "fuzz_targets.inc"
#undef FUZZ_TARGET

namespace {

using rubicon::bytes;

struct fuzz_target {
  std::string_view name;
  int (*run)(const std::uint8_t* data, std::size_t size);
};

constexpr fuzz_target targets[] = {
#define FUZZ_TARGET(name) {#name, fuzz_##name},
#include "fuzz_targets.inc"
#undef FUZZ_TARGET
};

constexpr unsigned long mutations_usually = 2000; ///< of each input

bytes read_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void mutate(bytes& input, rubicon::random_stream& rng) {
  for (auto edits = 1 + rng.below(4); edits > 0; --edits) {
    const auto at = input.empty() ? 0 : rng.below(input.size());
    switch (rng.below(4)) {
    case 0:
      if (!input.empty())
        input[at] = static_cast<std::uint8_t>(rng.next());
      break;
    case 1:
      if (!input.empty())
        input[at] ^= static_cast<std::uint8_t>(1U << rng.below(8));
      break;
    case 2:
      input.insert(input.begin() + static_cast<std::ptrdiff_t>(at),
                   static_cast<std::uint8_t>(rng.next()));
      break;
    case 3:
      input.resize(at);
      break;
    }
  }
}

} // namespace

int main(int argc, char* argv[]) {
  const auto* const target =
      argc == 3 || argc == 4 ? std::find_if(std::begin(targets), std::end(targets),
                                            [&](const fuzz_target& x) { return x.name == argv[1]; })
                             : std::end(targets);
  if (target == std::end(targets) || !std::filesystem::is_directory(argv[2])) {
    std::fprintf(stderr, "usage: %s TARGET CORPUS_FOLDER [MUTATIONS_OF_EACH]\n", argv[0]);
    return 2;
  }
  const auto mutations = argc == 4 ? std::strtoul(argv[3], nullptr, 10) : mutations_usually;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[2]))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end()); // folder order differs between file systems
  if (files.empty()) {
    std::fprintf(stderr, "empty corpus: %s\n", argv[2]);
    return 2;
  }
  rubicon::random_stream rng(1);
  for (const auto& file : files) {
    const auto original = read_file(file);
    target->run(original.data(), original.size());
    auto input = original;
    for (unsigned long i = 0; i < mutations; ++i) {
      if (i % 8 == 0)
        input = original;
      mutate(input, rng);
      target->run(input.data(), input.size());
    }
  }
  std::printf("%zu inputs, %lu mutations each\n", files.size(), mutations);
}
