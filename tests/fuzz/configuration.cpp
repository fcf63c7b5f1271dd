// Any text as configuration file and as override.
#include <cstdint>
#include <string>

#include "core/base/assert.hpp"
#include "daemon/configuration/loader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string input(reinterpret_cast<const char*>(bytes), size);
  const std::size_t end = input.find('\0');
  try {
    slamd::configuration::Loader loader;
    loader.add_text(input.substr(0, end), "fuzz.toml");
    if (end != std::string::npos) {
      loader.add_override(input.substr(end + 1));
    }
    const slamd::configuration::Configuration configuration = loader.load();
    // What was accepted prints as TOML that is accepted again, as the same configuration.
    const std::string printed = slamd::configuration::print_configuration(configuration);
    slamd::configuration::Loader again;
    again.add_text(printed, "printed.toml");
    SLAMD_ASSERT(slamd::configuration::print_configuration(again.load()) == printed);
  } catch (const slamd::configuration::ConfigurationError& error) {
    SLAMD_ASSERT(std::string(error.what()).find('\n') == std::string::npos);
  }
  return 0;
}
