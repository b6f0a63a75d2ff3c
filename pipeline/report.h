// report.json: what a run did, found and took, for people and programs.
#pragma once

#include <string>

#include "pipeline/run.h"

namespace glint {

// Deterministic but for "seconds" and "total_seconds". Lengths as their names say; angles in degrees.
std::string ReportJson(const RunSummary& summary);

}  // namespace glint
