// Meshes, and the head of OpenVDB files.
#include "io/mesh_formats.h"
#include "io/mesh_io.h"
#include "io/vdb_head.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace glint::fuzz {
namespace {

TriangleMesh Tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.colors.assign(4, {1, 2, 3});
  mesh.confidence.assign(4, 0.5f);
  mesh.scalars.emplace_back("sigma", std::vector<float>(4, 2.0f));
  return mesh;
}

std::string Written(const char* name) {
  const auto path = Scratch::Folder() / name;
  WriteMesh(path, Tetrahedron());
  return BytesOf(path);
}

constexpr const char* kPlyText =
    "ply\nformat ascii 1.0\ncomment c\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "property list uchar int extra\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face 1\nproperty list uchar int vertex_indices\nproperty int flag\nelement other 1\nproperty short s\n"
    "end_header\n0 0 0 1 9 1 2 3\n1 0 0 0 1 2 3\n1 1 0 0 1 2 3\n.5 .2 0 0 1 2 3\n0 1 0 0 1 2 3\n5 0 1 2 3 4 7\n8\n";

std::string BigEndianPly() {
  std::string out =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty short y\nproperty uint z\n"
      "element face 1\nproperty list ushort uint vertex_index\nend_header\n";
  const char coordinates[3] = {0x3F, 0x40, 0x41};  // first bytes of doubles
  for (const char first : coordinates) {
    out.append(1, first).append(7, '\0');        // x
    out.append(2, first).append("\0\0\0\1", 4);  // y and z
  }
  return out.append("\0\3\0\0\0\0\0\0\0\1\0\0\0\2", 14);
}

std::vector<std::string> PlySeeds() { return {kPlyText, BigEndianPly(), Written("t.ply")}; }

std::vector<std::string> ObjSeeds() {
  return {
      "# c\nv 0 0 0 1 0 0\nv 1 0 0 0.5 1 1\nv 1 1 0 0 0 0\nv 0 1 0 1 1 1\nvn 0 0 1\nvt 0 0\ng a\n"
      "f 1//1 2//1 \\\n3//1\nf -4 -2/1/1 -1\nf 1 2 3 4\n",
      Written("t.obj")};
}

std::vector<std::string> OffSeeds() {
  return {"OFF\n# c\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3 1 0 0\n",
          "CNOFF 3 1 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0.5 0.5 0.5 1\n0 1 0 0 0 1 1 2 3 4\n3 0 1 2\n"};
}

std::vector<std::string> StlSeeds() {
  std::string binary = "solid of a binary file";
  binary.resize(80, ' ');
  binary.append("\1\0\0\0", 4);
  for (const float value : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    binary.append(reinterpret_cast<const char*>(&value), sizeof(value));
  return {binary + std::string(2, '\0'),
          "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\n"
          "endsolid a\n"};
}

template <auto parse>
void RunMesh(std::string_view bytes) {
  Try([&] {
    const TriangleMesh mesh = parse(bytes, "mesh");
    for (const Eigen::Vector3i& face : mesh.faces)
      if (face.minCoeff() < 0 || face.maxCoeff() >= static_cast<int>(mesh.vertices.size())) std::abort();
  });
}

// Which format it is, is told by the content, too.
void RunAnyMesh(std::string_view bytes) {
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.stl", "mesh.off"}) {
    const auto path = ScratchFile(name, bytes);
    Try([&] { ReadMesh(path); });
    Try([&] { ReadPointCloud(path); });
  }
}

std::vector<std::string> AnySeeds() {
  std::vector<std::string> all;
  for (const auto& seeds : {PlySeeds(), ObjSeeds(), OffSeeds(), StlSeeds()})
    all.insert(all.end(), seeds.begin(), seeds.end());
  return all;
}

template <class T>
void Put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
void PutText(std::string& out, std::string_view text) {
  Put<uint32_t>(out, static_cast<uint32_t>(text.size()));
  out += text;
}

// The head of a file with one grid, whose data are left out: readers look at the directory first.
std::vector<std::string> VdbSeeds() {
  std::string out;
  Put<int64_t>(out, 0x56444220), Put<uint32_t>(out, 224), Put<uint32_t>(out, 10), Put<uint32_t>(out, 0);
  out += '\1';
  out += "01234567-89ab-cdef-0123-456789abcdef";
  Put<int32_t>(out, 1);
  PutText(out, "creator"), PutText(out, "string"), PutText(out, "Glint");
  Put<int32_t>(out, 1);
  PutText(out, "surface"), PutText(out, "Tree_float_5_4_3"), PutText(out, "");
  const auto here = static_cast<int64_t>(out.size() + 24);
  Put<int64_t>(out, here), Put<int64_t>(out, here), Put<int64_t>(out, here);
  return {out};
}

void RunVdbHead(std::string_view bytes) {
  Try([&] { internal::CheckVdbHead(ScratchFile("field.vdb", bytes)); });
}

}  // namespace

std::vector<Target> MeshTargets() {
  return {{"ply", RunMesh<internal::ParsePly>, PlySeeds},
          {"obj", RunMesh<internal::ParseObj>, ObjSeeds},
          {"off", RunMesh<internal::ParseOff>, OffSeeds},
          {"stl", RunMesh<internal::ParseStl>, StlSeeds},
          {"mesh", RunAnyMesh, AnySeeds},
          {"vdb_head", RunVdbHead, VdbSeeds}};
}

}  // namespace glint::fuzz
