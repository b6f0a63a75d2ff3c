// glint compare: how far a mesh is from a reference.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"
#include "highlights/overlay.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "light/light_io.h"
#include "metrics/swept_region.h"
#include "pipeline/artifacts.h"
#include "pipeline/commands/command.h"
#include "pipeline/commands/option_flags.h"
#include "pipeline/comparison.h"
#include "pipeline/error_map.h"
#include "pipeline/picture.h"
#include "pipeline/placement.h"
#include "pipeline/similarity.h"
#include "pipeline/terminal.h"
#include "pipeline/workspace.h"

namespace glint {
namespace {

constexpr double kLargestErrorShownDeg = 20;
constexpr double kDividedRel = 0.01;  // edges of a mesh that is coloured by its errors, of the reference's diagonal

struct Arguments {
  std::string mesh, reference, before, project, lights, transform, align, region, picture, highlights, error_map,
      error_mesh;
  bool json = false;
  double error_range_rel = 0;  // 0: chosen
  CompareOptions options;
  OptionTable table{options};
};

void AddWithComplement(const std::string& name, const std::string& rest, std::vector<uint8_t> mask,
                       std::vector<Region>& regions) {
  std::vector<uint8_t> complement(mask.size());
  std::transform(mask.begin(), mask.end(), complement.begin(), [](uint8_t in) { return in ? 0 : 1; });
  regions.push_back({name, std::move(mask)});
  regions.push_back({rest, std::move(complement)});
}

Region AttributeRegion(const Arguments& arguments, const TriangleMesh& reference) {
  for (const auto& [name, values] : reference.scalars) {
    if (name != arguments.region) continue;
    Region region{arguments.region + " > 0", std::vector<uint8_t>(values.size())};
    std::transform(values.begin(), values.end(), region.mask.begin(), [](float v) { return v > 0; });
    return region;
  }
  std::string known;
  for (const auto& [name, values] : reference.scalars) known += " " + name;
  throw InputError(
      arguments.reference, "--region " + arguments.region,
      known.empty() ? "the reference has no attributes" : "expected an attribute of the reference:" + known);
}

// The views and lights that the swept region and the picture are about, in the reference's frame.
struct Project {
  Scene scene;
  std::vector<Light> lights;
  ProjectPaths paths;
};

std::optional<Project> ReadProject(const Arguments& arguments, const Eigen::Affine3d& reference_from_mesh) {
  if (arguments.project.empty()) return std::nullopt;
  Project project;
  project.paths = FindProject(arguments.project);
  project.scene = MakeScene(ReadModel(project.paths.model));
  project.lights = ReadLights(arguments.lights);
  Transform(reference_from_mesh, project.scene);
  Transform(reference_from_mesh, project.lights);
  return project;
}

std::vector<Region> MakeRegions(const Arguments& arguments, const TriangleMesh& reference,
                                const std::optional<Project>& project) {
  std::vector<Region> regions;
  if (project)
    AddWithComplement("swept region", "outside the swept region",
                      SweptRegion(reference, project->scene, project->lights), regions);
  if (!arguments.region.empty()) {
    Region region = AttributeRegion(arguments, reference);
    const std::string name = region.name;
    AddWithComplement(name, "not " + name, std::move(region.mask), regions);
  }
  return regions;
}

std::vector<Highlight> AcceptedIn(const Arguments& arguments, const Scene& scene, const View& view) {
  std::vector<Highlight> accepted;
  for (const Highlight& h : ReadHighlights(arguments.highlights, scene.views.size()))
    if (&scene.views[h.view] == &view && h.status == HighlightStatus::kAccepted) accepted.push_back(h);
  return accepted;
}

void WritePicture(const Arguments& arguments, const Project& project, const std::vector<Candidate>& candidates,
                  const TriangleMesh& reference, const std::vector<Region>& regions) {
  const View& view = project.scene.views[MostTellingView(project.scene, reference, regions.front().mask)];
  cv::Mat photograph;
  ReadImage(PathForImage(project.paths.images, view.name, ""), photograph);
  if (!arguments.highlights.empty())
    photograph = DrawHighlights(photograph, AcceptedIn(arguments, project.scene, view));
  std::vector<PictureColumn> columns;
  for (const Candidate& c : candidates)
    columns.push_back({&c == &candidates.back() ? "after" : "before", &c.mesh, c.comparison.reference_normal_deg});
  WriteImagePng(arguments.picture,
                ComparisonSheet(photograph, arguments.highlights.empty() ? "photograph" : "photograph, highlights used",
                                columns, reference, view, kLargestErrorShownDeg));
}

// The errors of the last candidate as a coloured mesh; those of all as pictures.
void WriteErrors(const Arguments& arguments, std::vector<Candidate>& candidates, const TriangleMesh& reference) {
  const double diagonal = Diagonal(reference);
  std::vector<TriangleMesh> meshes;
  std::vector<ErrorField> fields;
  for (const Candidate& c : candidates) {
    meshes.push_back(Divided(c.mesh, kDividedRel * diagonal));
    fields.push_back(MeasureErrors(meshes.back(), reference));
  }
  const double largest_rel = arguments.error_range_rel > 0 ? arguments.error_range_rel : RoundErrorRange(fields);
  std::vector<ErrorRow> rows;
  for (size_t i = 0; i < candidates.size(); ++i) {
    Candidate& c = candidates[i];
    c.histogram = HistogramOf(fields[i], largest_rel);
    const ErrorStats& off = c.comparison.accuracy_rel;
    rows.push_back({c.name, ColoredByError(std::move(meshes[i]), fields[i], diagonal, largest_rel), c.histogram,
                    fmt::format("mean {:.3g} %, median {:.3g} %, 95 % below {:.3g} %, max {:.3g} %", 100 * off.mean,
                                100 * off.median, 100 * off.p95, 100 * off.max)});
  }
  if (!arguments.error_map.empty()) WriteImagePng(arguments.error_map, ErrorSheet(rows));
  if (!arguments.error_mesh.empty()) WriteMesh(arguments.error_mesh, rows.back().colored);
}

// A surface that distances can be measured on and from.
TriangleMesh ReadSurface(const std::string& path) {
  TriangleMesh mesh = WithoutUnusedVertices(ReadMesh(path));
  if (!(SurfaceArea(mesh) > 0))
    throw InputError(path, "", "the mesh has no extent: expected a surface, found no triangle with an area");
  return mesh;
}

void Compare(Arguments& arguments, Terminal& terminal) {
  CheckOptions(arguments.options);
  TriangleMesh reference = ReadSurface(arguments.reference), mesh = ReadSurface(arguments.mesh);
  EnsureNormals(reference);
  const Placement placed = PlaceOnReference(mesh, reference, arguments.transform, arguments.align, terminal);
  const std::optional<Project> project = ReadProject(arguments, placed.reference_from_mesh);
  const std::vector<Region> regions = MakeRegions(arguments, reference, project);
  std::vector<Candidate> candidates;
  for (const std::string& path : {arguments.before, arguments.mesh}) {
    if (path.empty()) continue;
    Candidate candidate{path, path == arguments.mesh ? mesh : ReadSurface(path), {}, {}};
    Transform(placed.reference_from_mesh, candidate.mesh);
    EnsureNormals(candidate.mesh);
    candidate.comparison = CompareMeshes(candidate.mesh, reference, arguments.options, {}, terminal);
    candidates.push_back(std::move(candidate));
  }
  if (!arguments.picture.empty()) WritePicture(arguments, *project, candidates, reference, regions);
  if (arguments.json || !arguments.error_map.empty() || !arguments.error_mesh.empty())
    WriteErrors(arguments, candidates, reference);
  terminal.Finish();
  if (!placed.doubt.empty()) terminal.Warn(placed.doubt);
  if (!placed.aligned.empty()) terminal.Info(placed.aligned);
  fmt::print("{}", arguments.json ? ComparisonJson(candidates, regions, placed.reference_from_mesh)
                                  : ComparisonTable(candidates, regions));
}

CLI::Validator HasExtension(const std::string& extension) {
  return {[extension](std::string& file) {
            return std::filesystem::path(file).extension() == extension
                       ? ""
                       : fmt::format("{}: expected a file name that ends in {}", file, extension);
          },
          "FILE" + extension};
}

}  // namespace

void AddCompareCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command =
      app.add_subcommand("compare", "Accuracy, completeness, Chamfer distance, F-score and normal error");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("MESH", arguments->mesh, "The mesh to measure")->required();
  command->add_option("REFERENCE", arguments->reference, "The truth; in another frame: see --align, --transform")
      ->required();
  command->add_option("--before", arguments->before, "Measure this mesh too, in a column beside it (the seed)");
  auto* project = command->add_option(
      "--project", arguments->project,
      "Also measure over the swept region (where a highlight passes in some view of this project) and outside it");
  auto* lights = command->add_option("--lights", arguments->lights, "The true lights, for --project");
  project->needs(lights);
  lights->needs(project);
  auto* picture = command->add_option("--picture", arguments->picture,
                                      "PNG to draw: photograph, meshes, errors of their normals; for --project");
  picture->needs(project);
  command
      ->add_option("--highlights", arguments->highlights,
                   "stages/highlights.json of a run, to draw into the photograph")
      ->needs(picture);
  command->add_option("--region", arguments->region,
                      "Also measure where this attribute of the reference's vertices is positive");
  command->add_option("--transform", arguments->transform,
                      "JSON with scale, R, t: x_in_reference = scale R x + t is applied to the meshes first");
  command
      ->add_option("--align", arguments->align,
                   "Then turn and move the meshes (rigid), or scale them too (similarity), so that MESH lies on the "
                   "reference")
      ->check(CLI::IsMember({"rigid", "similarity"}));
  command
      ->add_option("--error-map", arguments->error_map,
                   "PNG to draw: the mesh from four sides in the colours of its distance, and their histogram")
      ->check(HasExtension(".png"));
  command
      ->add_option("--error-mesh", arguments->error_mesh,
                   "PLY to write: the mesh, large triangles divided, with these colours and the distance as quality")
      ->check(HasExtension(".ply"));
  command
      ->add_option("--error-range", arguments->error_range_rel,
                   "Where these colours end, a fraction of the reference's diagonal; chosen if not given")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", arguments->json, "Print JSON");
  AddOptionFlags(*command, arguments->table);
  AddCommonOptions(*command, line);
  command->callback(
      [arguments, &line] { line.action = [arguments](Terminal& terminal) { Compare(*arguments, terminal); }; });
}

}  // namespace glint
