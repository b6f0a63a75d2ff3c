// JSON and YAML: lights, highlights and what else the workspace keeps, configuration, lists of projects.
#include "light/light_io.h"
#include "pipeline/artifacts.h"
#include "pipeline/batch_file.h"
#include "pipeline/config_file.h"
#include "pipeline/file_hashes.h"
#include "pipeline/outline_file.h"
#include "pipeline/similarity.h"
#include "pipeline/stage_record.h"
#include "pipeline/summary_json.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace glint::fuzz {
namespace {

// Every kind of option there is.
struct Part {
  double ratio = 0.5;
  int count = 3;
  bool on = true;
  std::string kind = "one";
  std::vector<double> list = {1, 2};
  void Visit(OptionVisitor& v) {
    v.Field({.name = "ratio", .help = "Ratio.", .unit = "px", .min = 0, .max = 1}, ratio);
    v.Field({.name = "count", .help = "Count.", .min = 0}, count);
    v.Field({.name = "on", .help = "On."}, on);
    v.Field({.name = "kind", .help = "Kind.", .choices = {"one", "two"}}, kind);
    v.Field({.name = "list", .help = "List."}, list);
  }
};
struct Whole {
  Part part, other;
  std::string label = "a \"label\"";
  void Visit(OptionVisitor& v) {
    VisitSection(v, "part", "A part.", part);
    VisitSection(v, "other", "Another.", other);
    v.Field({.name = "label", .help = "Label."}, label);
  }
};

void RunYaml(std::string_view bytes) {
  Try([&] {
    Whole whole;
    const OptionTable table(whole);
    ConfigProblems problems;
    ReadYamlFile(ScratchFile("config.yaml", bytes), table, problems);
    Violations(whole);
    // What was understood is written so that it reads back without a complaint.
    ConfigProblems none;
    Whole again;
    const OptionTable table_again(again);
    ReadYamlFile(ScratchFile("again.yaml", WriteYaml(table, "Title.")), table_again, none);
    if (!none.messages.empty()) std::abort();
  });
}

std::vector<std::string> YamlSeeds() {
  Whole whole;
  return {WriteYaml(OptionTable(whole), "Title."),
          "# c\npart: &p\n  ratio: 1e-3\n  list: [1, 2.5]\nother: *p\nlabel: 'x: y'\npart: {count: 1, ratoi: ~}\n"};
}

void RunSetting(std::string_view bytes) {
  Whole whole;
  const OptionTable table(whole);
  ConfigProblems problems;
  ApplySetting(std::string(bytes), table, problems);
  Violations(whole);
}

std::vector<std::string> SettingSeeds() { return {"part.ratio=0.25", "part.list=[1, 2]", "label=a b", "part.ratoi=1"}; }

void RunLights(std::string_view bytes) {
  const auto path = ScratchFile("lights.json", bytes);
  Try([&] { ReadLights(path); });
  Try([&] {
    const auto found = ReadFoundLights(path);
    const auto again = Scratch::Folder() / "again.json";
    WriteFoundLights(again, found);
    if (ReadFoundLights(again).size() != found.size()) std::abort();
  });
}

std::vector<std::string> LightSeeds() {
  return {
      R"({"lights": [{"type": "distant", "frame": "world", "direction_to_light": [0.3, -0.9, -0.2], "sigma_deg": 1,)"
      R"( "covariance": [1, 0, 0, 1, 0, 1], "support": 12, "conditioning": 0.5},)"
      R"( {"type": "point", "frame": "camera", "position": [0.1, 0, 0], "sigma": 0.01}],)"
      R"( "undetermined": [{"type": "distant", "frame": "camera", "direction_to_light": [0, 0, 1], "why": "few"}]})"};
}

void RunHighlights(std::string_view bytes) {
  const auto path = ScratchFile("highlights.json", bytes);
  Try([&] {
    for (const Highlight& h : ReadHighlights(path, 3, 2))
      if (h.view >= 3 || h.light >= 2 || !h.px.allFinite()) std::abort();
  });
}

std::vector<std::string> HighlightSeeds() {
  Highlight h;
  h.view = 2;
  h.px = {10.5, 20.25};
  h.light = 1;
  h.covariance_px = h.moments_px = Eigen::Matrix2d::Identity();
  const auto path = Scratch::Folder() / "written.json";
  WriteHighlights(path, {h, h});
  return {BytesOf(path)};
}

void RunFlags(std::string_view bytes) {
  const auto path = ScratchFile("flags.txt", bytes);
  Try([&] { ReadFlags(path, 4); });
}

void RunOutline(std::string_view bytes) {
  const auto path = ScratchFile("outline.txt", bytes);
  Try([&] {
    // What was read is what is written.
    const std::vector<OutlineSample> read = ReadOutline(path, 4);
    WriteOutline(path, read);
    if (ReadOutline(path, 4).size() != read.size()) std::abort();
  });
}

std::vector<std::string> OutlineSeeds() {
  OutlineSample s;
  s.view = 3;
  s.px = {1.5, 2};
  s.ray = Eigen::Vector3d(0.6, 0, 0.8);
  s.normal = Eigen::Vector3d(0, 1, 0);
  s.near = 1;
  s.depth = 1.5;
  s.far = 2;
  s.sigma = 1e-3;
  const auto path = Scratch::Folder() / "written.txt";
  WriteOutline(path, {s, s});
  return {BytesOf(path)};
}

// What a stage left of itself, and the summary within it.
void RunStageRecord(std::string_view bytes) {
  const auto record = ReadStageRecord(ScratchFile("record.json", bytes));
  if (!record) return;
  for (size_t stage = 0; stage < kRunStageNames.size(); ++stage) {
    RunSummary summary;
    TakeSummaryPart(static_cast<RunStage>(stage), record->summary, summary);
  }
}

std::vector<std::string> StageRecordSeeds() {
  std::vector<std::string> seeds;
  for (size_t stage = 0; stage < kRunStageNames.size(); ++stage) {
    RunSummary summary;
    summary.refine.iterations.resize(1);
    summary.lights.resize(1);
    StageRecord record;
    record.ingredients.emplace("program", "first build");
    record.left.emplace("mesh.ply", "hash");
    record.notes = record.warnings = {"said"};
    record.summary = SummaryPart(static_cast<RunStage>(stage), summary);
    const auto path = Scratch::Folder() / "written.json";
    WriteStageRecord(path, record);
    seeds.push_back(BytesOf(path));
  }
  return seeds;
}

void RunContacts(std::string_view bytes) {
  const auto path = ScratchFile("contacts.json", bytes);
  Scene scene;
  scene.views.resize(3);
  Try([&] {
    for (const Contact& c : ReadContacts(path, scene, 5, 2))
      if (c.view >= 3 || c.highlight >= 5 || c.light < 0 || c.light >= 2) std::abort();
  });
}

std::vector<std::string> ContactSeeds() {
  Contact contact;
  contact.light = 1;
  contact.origin = contact.direction = Eigen::Vector3d::UnitX();
  contact.axis_rays.fill(Eigen::Vector3d::UnitY());
  const auto path = Scratch::Folder() / "written.json";
  WriteContacts(path, {contact, contact});
  return {BytesOf(path)};
}

void RunBatch(std::string_view bytes) {
  Try([&] {
    for (const BatchProject& p : ReadBatchFile(ScratchFile("batch.yaml", bytes)))
      if (p.project.empty() || p.name.empty() || p.out.empty()) std::abort();
  });
}

std::vector<std::string> BatchSeeds() {
  return {
      "out: results\nset: {refine.levels: 3}\nprojects:\n  - scans/hood\n"
      "  - {project: scans/vase, name: vase-flash, config: flash.yaml, set: {a.b: 1}}\n",
      "lights: l.json\nprojects: [{project: a, out: b, mesh: c, images: d, masks: e}, a/]\n"};
}

// The hash of a file beside it, whatever is remembered.
void RunHashes(std::string_view bytes) {
  const auto file = ScratchFile("hashed", "x");
  FileHashes hashes(ScratchFile("hashes.json", bytes));
  if (hashes.Of(file).empty()) std::abort();
  hashes.Save();
}

std::vector<std::string> HashesSeeds() {
  FileHashes hashes(Scratch::Folder() / "none.json");
  hashes.Of(ScratchFile("hashed", "x"));
  hashes.Save();
  return {BytesOf(Scratch::Folder() / "none.json")};
}

void RunSimilarity(std::string_view bytes) {
  const auto path = ScratchFile("similarity.json", bytes);
  Try([&] {
    if (!ReadSimilarity(path).matrix().allFinite()) std::abort();
  });
}

std::vector<std::string> SimilaritySeeds() {
  return {R"({"scale": 2, "R": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "t": [1, -2, 0.5]})"};
}

std::vector<std::string> FlagSeeds() { return {"0101\n"}; }

}  // namespace

std::vector<Target> TextTargets() {
  return {{"config_yaml", RunYaml, YamlSeeds},
          {"setting", RunSetting, SettingSeeds},
          {"lights_json", RunLights, LightSeeds},
          {"highlights_json", RunHighlights, HighlightSeeds},
          {"stage_record", RunStageRecord, StageRecordSeeds},
          {"contacts_json", RunContacts, ContactSeeds},
          {"batch_yaml", RunBatch, BatchSeeds},
          {"hashes_json", RunHashes, HashesSeeds},
          {"similarity_json", RunSimilarity, SimilaritySeeds},
          {"flags", RunFlags, FlagSeeds},
          {"outline", RunOutline, OutlineSeeds}};
}

}  // namespace glint::fuzz
