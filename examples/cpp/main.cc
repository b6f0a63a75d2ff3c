// Glint from C++.
//   example MESH X Y Z        the signed distance of a point to a mesh, and the mesh by way of a level set
//   example PROJECT OUT       what `glint run PROJECT -o OUT` does, with coarse voxels
#include <glint/core/error.h>
#include <glint/io/mesh_io.h>
#include <glint/pipeline/run.h>
#include <glint/sdf/extract_mesh.h>
#include <glint/sdf/mesh_to_level_set.h>
#include <glint/sdf/signed_distance.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

// Stages report to a Progress; this one prints when a unit of work begins.
class Lines : public glint::Progress {
 public:
  void Begin(std::string_view what, size_t total) override {
    if (!what.empty()) std::printf("%.*s (%zu)\n", static_cast<int>(what.size()), what.data(), total);
  }
};

void Measure(const std::string& file, const Eigen::Vector3d& point) {
  const glint::TriangleMesh mesh = glint::ReadMesh(file);
  glint::SdfSummary summary;
  const double distance = glint::SignedDistance(mesh, {point}, "auto", &summary).front();
  std::printf("distance %.6f, signed by %s\n", distance, summary.sign.c_str());
  const glint::LevelSet field = glint::MeshToLevelSet(mesh, glint::Diagonal(mesh) / 64);
  std::printf("%zu faces, %zu voxels, %zu faces again\n", mesh.faces.size(), field.num_active_voxels(),
              glint::ExtractMesh(field).faces.size());
}

void Reconstruct(const std::string& project, const std::string& out) {
  glint::RunArguments arguments;
  arguments.project = project;
  arguments.out = out;
  const glint::Config config = glint::ResolveConfig({}, {"refine.voxel_rel=0.03", "refine.levels=1"});
  Lines lines;
  const glint::RunSummary summary = glint::Run(arguments, config, lines);
  std::printf("%s: %zu faces\n", summary.outcome.c_str(), summary.num_faces);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 5) {
      Measure(argv[1], {std::atof(argv[2]), std::atof(argv[3]), std::atof(argv[4])});
    } else if (argc == 3) {
      Reconstruct(argv[1], argv[2]);
    } else {
      std::fprintf(stderr, "usage: example MESH X Y Z | example PROJECT OUT\n");
      return 2;
    }
  } catch (const glint::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
  return 0;
}
