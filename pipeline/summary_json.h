// The parts of a run's summary that each stage fills, as JSON and back, so that a run that takes a stage from an
// earlier one reports the same. Everything reads back to exactly what was written.
#pragma once

#include <filesystem>
#include <string>

#include "constraints/contact.h"
#include "pipeline/run.h"

namespace glint {

// The stage's part of `summary` as a JSON text.
std::string SummaryPart(RunStage stage, const RunSummary& summary);

// Puts it back. False, and `summary` as it was, where the text is not what SummaryPart() writes.
bool TakeSummaryPart(RunStage stage, const std::string& text, RunSummary& summary);

// Contacts but for their cam_from_world, which is the view's. Reading throws InputError naming the file when it is
// missing or malformed or names a view that `scene` does not have.
void WriteContacts(const std::filesystem::path& path, const std::vector<Contact>& contacts);
std::vector<Contact> ReadContacts(const std::filesystem::path& path, const Scene& scene, size_t num_highlights,
                                  size_t num_lights);

}  // namespace glint
