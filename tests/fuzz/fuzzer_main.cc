// libFuzzer's entry: the environment variable GLINT_FUZZ_TARGET names the reader. `--seeds FOLDER` as the first
// argument writes the seeds of all readers into FOLDER/NAME/.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/fuzz/targets.h"

namespace {

const glint::fuzz::Target* target = nullptr;

int WriteSeeds(const std::filesystem::path& folder) {
  for (const glint::fuzz::Target& each : glint::fuzz::Targets()) {
    std::filesystem::create_directories(folder / each.name);
    int number = 0;
    for (const std::string& seed : each.seeds())
      std::ofstream(folder / each.name / ("seed_" + std::to_string(number++)), std::ios::binary) << seed;
    std::printf("%s\n", std::string(each.name).c_str());
  }
  return 0;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc == 3 && std::string((*argv)[1]) == "--seeds") std::exit(WriteSeeds((*argv)[2]));
  const char* name = std::getenv("GLINT_FUZZ_TARGET");
  target = name ? glint::fuzz::FindTarget(name) : nullptr;
  if (target) return 0;
  std::fprintf(stderr, "GLINT_FUZZ_TARGET must name a reader; --seeds FOLDER lists them\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  target->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
