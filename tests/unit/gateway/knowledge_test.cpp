#include <cctype>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/catch.hpp"

namespace {

/// The sources of the gateway, core and actor.
std::vector<std::filesystem::path> sources() {
  const std::filesystem::path root(RUBICON_SOURCE_DIR);
  std::vector<std::filesystem::path> all{root / "actors/services/gateway.hpp",
                                         root / "actors/services/gateway.cpp",
                                         root / "actors/services/gateway_report.cpp"};
  for (const auto* folder : {"src/gateway", "src/gateway/others"})
    for (const auto& each : std::filesystem::directory_iterator(root / folder))
      if (each.path().extension() == ".cpp" || each.path().extension() == ".hpp")
        all.push_back(each.path());
  return all;
}

/// In lower case.
std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  REQUIRE(in);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  for (auto& c : text)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Does a word of the text begin so?
bool begins_a_word(const std::string& text, const std::string& with) {
  for (auto at = text.find(with); at != std::string::npos; at = text.find(with, at + 1)) {
    if (at == 0 || std::isalpha(static_cast<unsigned char>(text[at - 1])) == 0)
      return true; // "in flight" is no light
  }
  return false;
}

} // namespace

TEST_CASE("a gateway knows nothing of what motes measure and do", "[gateway][GW-02][PXY-02]") {
  const auto all = sources();
  REQUIRE(all.size() > 8);
  for (const auto& file : all) {
    const auto text = text_of(file);
    REQUIRE(!text.empty());
    for (const std::string word :
         {"transducer", "actuator", "temperature", "humidity", "light", "dimmer", "lamp",
          "#include \"proxy/", "#include \"mote/descriptor"}) {
      CAPTURE(file.filename().string(), word);
      CHECK(!begins_a_word(text, word));
    }
  }
}
