// What is wrong with a command line, as a person at the shell wants to read it.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace glint {

// `arguments`: those after the program's name. A misspelt command or flag is told with the nearest one; of a command
// line with none of either all commands are told.
std::string DescribeUsageError(const CLI::App& app, const CLI::Error& error, const std::vector<std::string>& arguments);

}  // namespace glint
