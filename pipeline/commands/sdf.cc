// glint sdf: a mesh as a narrow-band signed distance field.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <string>

#include "core/error.h"
#include "geometry/clean_mesh.h"
#include "io/mesh_io.h"
#include "io/vdb_io.h"
#include "pipeline/commands/command.h"
#include "pipeline/commands/option_flags.h"
#include "pipeline/terminal.h"
#include "sdf/memory_budget.h"
#include "sdf/mesh_to_level_set.h"

namespace glint {
namespace {

struct Arguments {
  std::string mesh, out;
  double voxel_rel = 1.0 / 256;
  int resolution = 0;
  SdfOptions options;
  OptionTable table{options};
};

void MakeField(const Arguments& arguments, Terminal& terminal) {
  CheckOptions(arguments.options);
  if (!std::isfinite(arguments.voxel_rel))
    throw InputError("", "--voxel-rel", fmt::format("expected a fraction, found {}", arguments.voxel_rel));
  const TriangleMesh mesh = ReadMesh(arguments.mesh);
  CheckMesh(mesh);
  const Eigen::Vector3d extent = BoundingBox(mesh).sizes();
  const double voxel =
      arguments.resolution > 0 ? extent.maxCoeff() / arguments.resolution : arguments.voxel_rel * Diagonal(mesh);
  if (!(voxel > 0)) throw InputError(arguments.mesh, "", "the mesh has no extent: all its vertices coincide");
  const auto gigabytes = [&](bool by_winding) {
    return PredictBandBytes(mesh, arguments.options.half_width_voxels, voxel, by_winding) / 1e9;
  };
  terminal.Info(
      fmt::format("{} faces, voxels of {:g}: about {:.3g} GB of memory, {:.3g} GB if signed by winding number",
                  mesh.faces.size(), voxel, gigabytes(false), gigabytes(true)));
  terminal.Begin("signed distance", 0);
  SdfSummary summary;
  const LevelSet field = MeshToLevelSet(mesh, voxel, arguments.options, &summary);
  terminal.Finish();
  if (summary.turned) terminal.Warn("the mesh was inside out and has been turned");
  WriteVdb(arguments.out, field);
  terminal.Info(fmt::format("signed by {}: {}\n{}: {} active voxels of {:g}, {:.1f} MB", summary.sign, summary.reason,
                            arguments.out, field.num_active_voxels(), field.voxel_size(),
                            static_cast<double>(field.memory_bytes()) / 1e6));
}

}  // namespace

void AddSdfCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("sdf", "A mesh as a signed distance field (OpenVDB)");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("MESH", arguments->mesh, "PLY, OBJ, OFF or STL")->required();
  command->add_option("-o,--out", arguments->out, "The .vdb file to write")->required();
  auto* voxel = command->add_option("--voxel-rel", arguments->voxel_rel, "Voxel size, fraction of the mesh's diagonal")
                    ->check(CLI::Range(1e-6, 1.0))
                    ->capture_default_str();
  command->add_option("--resolution", arguments->resolution, "Voxels along the mesh's longest side, instead")
      ->check(CLI::Range(1, 1000000))
      ->excludes(voxel);
  command->add_option("--band", arguments->options.half_width_voxels, "Half width of the band, in voxels")
      ->capture_default_str();
  AddOptionFlags(*command, arguments->table, {"half_width_voxels"});
  AddCommonOptions(*command, line);
  command->callback(
      [arguments, &line] { line.action = [arguments](Terminal& terminal) { MakeField(*arguments, terminal); }; });
}

}  // namespace glint
