// One run of glint as a program of its own, so that whatever becomes of it stops nothing else.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace glint {

// Starts this program with `arguments` and hands every line of its standard output to `line`; its standard error is
// dropped. Once `cancelled` says so it is asked to stop (SIGTERM), once. It does not outlive this process. Returns its
// exit code, or 128 + the signal that ended it. Throws InputError where the system refuses to start it.
int RunChild(const std::vector<std::string>& arguments, const std::function<void(const std::string&)>& line,
             const std::function<bool()>& cancelled);

}  // namespace glint
