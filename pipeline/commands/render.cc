// glint render: a picture of a signed distance field, or of a mesh.
#include "sdf/render.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "geometry/render_mesh.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "io/vdb_io.h"
#include "pipeline/commands/command.h"
#include "pipeline/terminal.h"

namespace glint {
namespace {

struct Arguments {
  std::string file, out;
  double iso_world = 0;
  int width = 800, height = 600;
  std::vector<double> direction = {0.5, -0.4, -1}, up = {0, 1, 0};
  bool edges = false;
};

Eigen::Vector3d ToVector(const std::vector<double>& x, const char* name) {
  const Eigen::Vector3d v(x[0], x[1], x[2]);
  if (!v.allFinite() || !(v.norm() > 0))
    throw InputError("", name, fmt::format("expected a direction, found ({}, {}, {})", x[0], x[1], x[2]));
  return v.normalized();
}

// The box of the surface φ = iso: that of the active voxels without the rest of the band about it.
Eigen::AlignedBox3d BoxOfSurface(const LevelSet& field, double iso_world) {
  const Eigen::AlignedBox3d active = field.ActiveBox();
  const double rest = (field.half_width_voxels() - 1) * field.voxel_size() - iso_world;
  const Eigen::Vector3d inset = Eigen::Vector3d::Constant(rest);
  const Eigen::AlignedBox3d box(active.min() + inset, active.max() - inset);
  return box.isEmpty() ? active : box;
}

std::vector<uint8_t> RenderField(const Arguments& arguments, const Eigen::Vector3d& direction,
                                 const Eigen::Vector3d& up) {
  const LevelSet field = ReadVdb(arguments.file);
  if (field.empty()) throw NoResultError(arguments.file + ": the field is empty");
  const PictureView view =
      ViewOfBox(BoxOfSurface(field, arguments.iso_world), direction, up, arguments.width, arguments.height);
  return RenderLevelSet(field, view, arguments.iso_world);
}

std::vector<uint8_t> RenderMeshFile(const Arguments& arguments, const Eigen::Vector3d& direction,
                                    const Eigen::Vector3d& up) {
  if (arguments.iso_world != 0) throw InputError(arguments.file, "--iso", "only a .vdb file has other levels than 0");
  const TriangleMesh mesh = ReadMesh(arguments.file);
  MeshLook look;
  look.edges = arguments.edges;
  return RenderMesh(mesh, ViewOfBox(BoundingBox(mesh), direction, up, arguments.width, arguments.height), look);
}

void Render(const Arguments& arguments, Terminal& terminal) {
  const Eigen::Vector3d direction = ToVector(arguments.direction, "--direction"), up = ToVector(arguments.up, "--up");
  if (std::filesystem::path(arguments.out).extension() != ".png")
    throw InputError(arguments.out, "", "expected a file name that ends in .png");
  const bool is_field = std::filesystem::path(arguments.file).extension() == ".vdb";
  terminal.Begin("render", 0);
  std::vector<uint8_t> pixels =
      is_field ? RenderField(arguments, direction, up) : RenderMeshFile(arguments, direction, up);
  terminal.Finish();
  const cv::Mat rgb(arguments.height, arguments.width, CV_8UC3, pixels.data());
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  WriteImagePng(arguments.out, bgr);
  terminal.Info(fmt::format("{}: {} × {} pixels", arguments.out, arguments.width, arguments.height));
}

}  // namespace

void AddRenderCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("render", "A picture of a signed distance field at any level, or of a mesh");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->file, "A .vdb file with a level set, or a mesh")->required();
  command->add_option("-o,--out", arguments->out, "The .png file to write")->required();
  command->add_option("--iso", arguments->iso_world, "Level in world units; 0 is the surface")->capture_default_str();
  command->add_option("--width", arguments->width, "Pixels")->check(CLI::Range(1, 16384))->capture_default_str();
  command->add_option("--height", arguments->height, "Pixels")->check(CLI::Range(1, 16384))->capture_default_str();
  command->add_option("--direction", arguments->direction, "Where the camera looks: X Y Z")
      ->expected(3)
      ->capture_default_str();
  command->add_option("--up", arguments->up, "What is up in the picture: X Y Z")->expected(3)->capture_default_str();
  command->add_flag("--edges", arguments->edges, "Draw the triangles' edges, of a mesh");
  AddCommonOptions(*command, line);
  command->callback(
      [arguments, &line] { line.action = [arguments](Terminal& terminal) { Render(*arguments, terminal); }; });
}

}  // namespace glint
