// glint mesh: the surface of a signed distance field.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "core/error.h"
#include "io/mesh_io.h"
#include "io/vdb_io.h"
#include "pipeline/commands/command.h"
#include "pipeline/terminal.h"
#include "sdf/extract_mesh.h"

namespace glint {
namespace {

struct Arguments {
  std::string field, out;
  double iso_world = 0;
};

void MakeMesh(const Arguments& arguments, Terminal& terminal) {
  const LevelSet field = ReadVdb(arguments.field);
  terminal.Begin("mesh", 0);
  const TriangleMesh mesh = ExtractMesh(field, arguments.iso_world);
  terminal.Finish();
  if (mesh.empty())
    throw NoResultError(fmt::format("{}: no surface at level {:g}", arguments.field, arguments.iso_world));
  WriteMesh(arguments.out, mesh);
  terminal.Info(fmt::format("{}: {} vertices, {} faces", arguments.out, mesh.vertices.size(), mesh.faces.size()));
}

}  // namespace

void AddMeshCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("mesh", "The surface of a signed distance field at any level");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("FIELD", arguments->field, "A .vdb file with a level set")->required();
  command->add_option("-o,--out", arguments->out, "The mesh to write: .ply, .obj or .glb")->required();
  command->add_option("--iso", arguments->iso_world, "Level in world units; 0 is the surface")->capture_default_str();
  AddCommonOptions(*command, line);
  command->callback(
      [arguments, &line] { line.action = [arguments](Terminal& terminal) { MakeMesh(*arguments, terminal); }; });
}

}  // namespace glint
