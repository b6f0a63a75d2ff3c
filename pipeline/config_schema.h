// The JSON Schema of configuration files, for editors that complete and check while one types.
#pragma once

#include <string>

#include "pipeline/option_table.h"

namespace glint {

// Draft 7, which YAML editors know: every option with type, default, range, choices and help; other keys are errors.
std::string JsonSchema(const OptionTable& table);

}  // namespace glint
