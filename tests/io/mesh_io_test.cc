#include "io/mesh_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/error.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ReadText;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

// A closed octahedron with every attribute, at `center` and of the given size.
TriangleMesh Octahedron(const Eigen::Vector3d& center = Eigen::Vector3d::Zero(), double size = 1) {
  TriangleMesh mesh;
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {-1.0, 1.0}) mesh.normals.push_back(sign * Eigen::Vector3d::Unit(k));
  }
  std::vector<float> depth;
  for (size_t i = 0; i < 6; ++i) {
    mesh.vertices.push_back(center + size * mesh.normals[i]);
    mesh.colors.push_back({static_cast<uint8_t>(40 * i), 0, 255});
    mesh.confidence.push_back(0.125f * static_cast<float>(i));
    depth.push_back(static_cast<float>(i) - 2.5f);
  }
  mesh.scalars.emplace_back("depth", depth);
  for (int octant = 0; octant < 8; ++octant) {
    const int x = octant & 1, y = 2 + (octant >> 1 & 1), z = 4 + (octant >> 2 & 1);
    const bool is_even = ((octant & 1) + (octant >> 1 & 1) + (octant >> 2 & 1)) % 2 == 1;
    mesh.faces.push_back(is_even ? Eigen::Vector3i(x, y, z) : Eigen::Vector3i(y, x, z));
  }
  return mesh;
}

std::string ErrorOf(const fs::path& path) {
  try {
    ReadMesh(path);
  } catch (const InputError& error) {
    EXPECT_EQ(error.path(), path.string());
    return error.what();
  }
  return "";
}

template <class T>
std::string Bytes(T value, bool big_endian = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof(value));
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

TEST(MeshIo, PlyKeepsEveryAttribute) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = Octahedron();
  ASSERT_NEAR(SignedVolume(mesh), 4.0 / 3, 1e-12);
  WriteMesh(folder / "a.ply", mesh);
  const TriangleMesh read = ReadMesh(folder / "a.ply");
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.faces, mesh.faces);
  EXPECT_EQ(read.normals, mesh.normals);
  EXPECT_EQ(read.colors, mesh.colors);
  EXPECT_EQ(read.confidence, mesh.confidence);
  EXPECT_EQ(read.scalars, mesh.scalars);
  WriteMesh(folder / "b.ply", read);
  EXPECT_EQ(ReadText(folder / "a.ply"), ReadText(folder / "b.ply"));
}

TEST(MeshIo, ObjKeepsGeometryNormalsAndColors) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = Octahedron();
  WriteMesh(folder / "a.obj", mesh);
  const TriangleMesh read = ReadMesh(folder / "a.obj");
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.faces, mesh.faces);
  EXPECT_EQ(read.normals, mesh.normals);
  EXPECT_EQ(read.colors, mesh.colors);
}

TEST(MeshIo, AnyScaleAndPlaceKeepsItsDigits) {
  const TemporaryFolder folder;
  for (const double size : {1e-6, 1.0, 1e6}) {
    for (const double place : {0.0, 1.0, 1e3, 1e7}) {
      const TriangleMesh mesh = Octahedron(Eigen::Vector3d(0.3, 1, -0.7) * size * place, size);
      for (const std::string name : {"a.ply", "a.obj"}) {
        WriteMesh(folder / name, mesh);
        const TriangleMesh read = ReadMesh(folder / name);
        for (size_t i = 0; i < mesh.vertices.size(); ++i) {
          EXPECT_LT((read.vertices[i] - mesh.vertices[i]).norm(), 2e-6 * size) << name << " " << size << " " << place;
        }
      }
    }
  }
}

TEST(MeshIo, GlbIsWhatGltfAsksFor) {
  const TemporaryFolder folder;
  WriteMesh(folder / "a.glb", Octahedron(Eigen::Vector3d(1e7, 0, 0)));
  const std::string bytes = ReadText(folder / "a.glb");
  const auto word = [&](size_t at) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  ASSERT_EQ(word(8), bytes.size());
  const uint32_t json_size = word(12);
  EXPECT_EQ(json_size % 4, 0u);
  const auto document = nlohmann::json::parse(bytes.substr(20, json_size));
  const size_t bin = 20 + json_size;
  EXPECT_EQ(word(bin) + bin + 8, bytes.size());
  const auto& primitive = document["meshes"][0]["primitives"][0];
  const auto view = [&](const nlohmann::json& accessor) {
    return document["bufferViews"][accessor["bufferView"].get<int>()];
  };
  const auto& position = document["accessors"][primitive["attributes"]["POSITION"].get<int>()];
  EXPECT_EQ(position["count"], 6);
  EXPECT_EQ(position["min"], nlohmann::json({-1.0, -1.0, -1.0}));
  EXPECT_EQ(position["max"], nlohmann::json({1.0, 1.0, 1.0}));
  EXPECT_EQ(document["nodes"][0]["translation"], nlohmann::json({1e7, 0.0, 0.0}));
  EXPECT_EQ(document["accessors"][primitive["indices"].get<int>()]["count"], 24);
  for (const char* name : {"NORMAL", "COLOR_0", "_CONFIDENCE", "_DEPTH"}) {
    EXPECT_TRUE(primitive["attributes"].contains(name)) << name;
  }
  for (const auto& accessor : document["accessors"]) {
    const auto v = view(accessor);
    EXPECT_EQ(v["byteOffset"].get<size_t>() % 4, 0u);
    EXPECT_LE(v["byteOffset"].get<size_t>() + v["byteLength"].get<size_t>(),
              document["buffers"][0]["byteLength"].get<size_t>());
  }
  float x;
  std::memcpy(&x, bytes.data() + bin + 8 + view(position)["byteOffset"].get<size_t>(), 4);
  EXPECT_EQ(x, -1.0f);  // relative to the node
}

TEST(MeshIo, WritingIsAtomicAndCreatesFolders) {
  const TemporaryFolder folder;
  WriteMesh(folder / "deep/er/a.ply", Octahedron());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "deep/er"), {}), 1);
  EXPECT_THROW(WriteMesh(folder / "a.xyz", Octahedron()), InputError);
  fs::create_directories(folder / "b.ply");
  EXPECT_THROW(WriteMesh(folder / "b.ply", Octahedron()), InputError);
  WriteFile(folder / "file", "x");
  EXPECT_THROW(WriteMesh(folder / "file/a.ply", Octahedron()), InputError);
}

// --- PLY as others write it ---

constexpr const char* kAsciiPly =
    "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nobj_info x\r\nelement vertex 5\r\nproperty double x\r\n"
    "property double y\r\nproperty double z\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n"
    "property uchar alpha\r\nproperty list uchar int neighbors\r\nelement face 2\r\nproperty uchar flags\r\n"
    "property list uchar uint vertex_index\r\nelement edge 1\r\nproperty int vertex1\r\nproperty int vertex2\r\n"
    "end_header\r\n0 0 0 255 0 0 255 0\r\n1 0 0 0 255 0 255 2 7 8\r\n1 1 0 0 0 255 255 0\r\n0 1 0 1 2 3 255 0\r\n"
    "+.5 .5 1e0 9 9 9 255 1 4\r\n1 4 0 1 2 3\r\n0 3 0 1 4\r\n0 1\r\n";

TEST(PlyRead, AsciiWithPolygonsListsAndOtherElements) {
  const TemporaryFolder folder;
  WriteFile(folder / "a.ply", kAsciiPly);
  const TriangleMesh mesh = ReadMesh(folder / "a.ply");
  ASSERT_EQ(mesh.vertices.size(), 5);
  EXPECT_EQ(mesh.vertices[4], Eigen::Vector3d(0.5, 0.5, 1));
  EXPECT_EQ(mesh.faces.size(), 3);
  EXPECT_EQ(mesh.colors[3], (std::array<uint8_t, 3>{1, 2, 3}));
  ASSERT_EQ(mesh.scalars.size(), 1);
  EXPECT_EQ(mesh.scalars[0].first, "alpha");
}

TEST(PlyRead, BothEndiansAndAllTypes) {
  const TemporaryFolder folder;
  for (const bool big : {false, true}) {
    std::string ply = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                      "_endian 1.0\nelement vertex 3\nproperty float x\nproperty int16 y\nproperty float64 z\n"
                      "property int8 a\nproperty uint16 b\nproperty uint32 c\nelement face 1\n"
                      "property list int32 uint16 vertex_indices\nend_header\n";
    for (int i = 0; i < 3; ++i) {
      ply += Bytes(0.5f * i, big) + Bytes(int16_t(-300 * i * i), big) + Bytes(1e-3 * i, big) + Bytes(int8_t(-i)) +
             Bytes(uint16_t(60000 + i), big) + Bytes(uint32_t(1u << 24), big);
    }
    ply += Bytes(int32_t{3}, big) + Bytes(uint16_t{0}, big) + Bytes(uint16_t{1}, big) + Bytes(uint16_t{2}, big);
    WriteFile(folder / "a.ply", ply);
    const TriangleMesh mesh = ReadMesh(folder / "a.ply");
    EXPECT_EQ(mesh.vertices[2], Eigen::Vector3d(1, -1200, 2e-3));
    EXPECT_EQ(mesh.faces[0], Eigen::Vector3i(0, 1, 2));
    EXPECT_EQ(mesh.scalars[1].second[2], 60002.0f);
  }
}

TEST(PlyRead, PointCloudsHaveNoFaces) {
  const TemporaryFolder folder;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "nx\n"
      "property float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar "
      "blue\nend_header\n"
      "1 2 3 0 0 2 10 20 30\n4 5 6 0 0 0 1 1 1\n";
  WriteFile(folder / "fused.ply", ply);
  const PointCloud cloud = ReadPointCloud(folder / "fused.ply");
  ASSERT_EQ(cloud.positions.size(), 2);
  EXPECT_EQ(cloud.normals[0], Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(cloud.normals[1], Eigen::Vector3d::Zero());
  EXPECT_EQ(cloud.colors[0], (std::array<uint8_t, 3>{10, 20, 30}));
  EXPECT_THAT(ErrorOf(folder / "fused.ply"), HasSubstr("expected a mesh, found no face (2 vertices)"));
}

TEST(PlyRead, ConfidenceOutsideItsRangeIsAPlainScalar) {
  const TemporaryFolder folder;
  TriangleMesh mesh = Octahedron();
  mesh.confidence[2] = 7;
  WriteMesh(folder / "a.ply", mesh);
  const TriangleMesh read = ReadMesh(folder / "a.ply");
  EXPECT_TRUE(read.confidence.empty());
  EXPECT_EQ(read.scalars[0].first, "confidence");
}

TEST(PolygonRead, ConcavePolygonsAreCutIntoEars) {
  const TemporaryFolder folder;
  // An arrow head (quad, one corner pushed in) and an L of six corners.
  WriteFile(folder / "a.obj",
            "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\nf 2 3 4 1\n"
            "v 10 0 0\nv 13 0 0\nv 13 1 0\nv 11 1 0\nv 11 3 0\nv 10 3 0\nf 5 6 7 8 9 10\nf 8 9 10 5 6 7\n");
  const TriangleMesh mesh = ReadMesh(folder / "a.obj");
  ASSERT_EQ(mesh.faces.size(), 2 + 2 + 4 + 4);
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    EXPECT_GT(FaceNormal(mesh, f).z(), 0.99) << f;
  }
  EXPECT_NEAR(SurfaceArea(mesh), 2 * 4 + 2 * 5, 1e-12);
}

TEST(ObjRead, IndicesFromTheEndTexturesAndContinuedLines) {
  const TemporaryFolder folder;
  WriteFile(folder / "a.obj",
            "# cube corner\nmtllib x.mtl\no thing\nv 0 0 0 1.0\nv 1 0 0 1.0\nv 0 1 0 1.0 \nvt 0 0\nvn 0 0 1\nusemtl "
            "a\ns off\n"
            "f -3/1/1 -2/1/1 \\\n -1/1/1\nl 1 2\np 1\nv 0 0 1\nf 1//1 2//1 4//1\n");
  const TriangleMesh mesh = ReadMesh(folder / "a.obj");
  ASSERT_EQ(mesh.faces.size(), 2);
  EXPECT_EQ(mesh.faces[0], Eigen::Vector3i(0, 1, 2));
  EXPECT_EQ(mesh.faces[1], Eigen::Vector3i(0, 1, 3));
  EXPECT_EQ(mesh.normals.size(), 4);
  EXPECT_TRUE(mesh.colors.empty());
}

TEST(ObjRead, NormalsThatDifferBetweenCornersAreLeftOut) {
  const TemporaryFolder folder;
  WriteFile(folder / "a.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1//2 2//2 4//2\n");
  EXPECT_TRUE(ReadMesh(folder / "a.obj").normals.empty());
}

TEST(OffRead, ColorsNormalsAndComments) {
  const TemporaryFolder folder;
  WriteFile(folder / "a.off",
            "CNOFF # colours and normals\n3 1 0\n\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 255 0 255\n"
            "# between\n0 1 0 0 0 1 0.5 0.5 0.5 1\n3 0 1 2 0.1 0.2 0.3\n");
  const TriangleMesh mesh = ReadMesh(folder / "a.off");
  EXPECT_EQ(mesh.colors[0], (std::array<uint8_t, 3>{255, 0, 0}));
  EXPECT_EQ(mesh.colors[2], (std::array<uint8_t, 3>{128, 128, 128}));
  EXPECT_EQ(mesh.normals[1], Eigen::Vector3d::UnitZ());
}

std::string BinaryStl(const TriangleMesh& mesh, const std::string& header) {
  std::string stl = header + std::string(80 - header.size(), ' ') + Bytes(static_cast<uint32_t>(mesh.faces.size()));
  for (const auto& face : mesh.faces) {
    stl += Bytes(0.0f) + Bytes(0.0f) + Bytes(0.0f);
    for (const int v : face) {
      for (const double value : mesh.vertices[v]) stl += Bytes(static_cast<float>(value));
    }
    stl += Bytes(uint16_t{0});
  }
  return stl;
}

TEST(StlRead, BinaryAndAsciiAreTheSameMesh) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = Octahedron();
  std::string ascii = "solid octahedron\n";
  for (const auto& face : mesh.faces) {
    ascii += "  facet normal 0 0 0\n    outer loop\n";
    for (const int v : face) {
      const auto& x = mesh.vertices[v];
      ascii +=
          "      vertex " + std::to_string(x.x()) + " " + std::to_string(x.y()) + " " + std::to_string(x.z()) + "\n";
    }
    ascii += "    endloop\n  endfacet\n";
  }
  WriteFile(folder / "a.stl", ascii + "endsolid octahedron\n");
  WriteFile(folder / "b.stl", BinaryStl(mesh, "made by hand"));
  WriteFile(folder / "c.stl", BinaryStl(mesh, "solid but binary"));
  for (const std::string name : {"a.stl", "b.stl", "c.stl"}) {
    const TriangleMesh read = ReadMesh(folder / name);
    EXPECT_EQ(read.vertices.size(), 6) << name;
    EXPECT_EQ(read.faces.size(), 8) << name;
    EXPECT_NEAR(SignedVolume(read), 4.0 / 3, 1e-6) << name;
  }
}

// --- hostile input ---

struct BadMesh {
  std::string test, file, content, message;
};

class BadMeshFile : public testing::TestWithParam<BadMesh> {};

const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n";

INSTANTIATE_TEST_SUITE_P(
    Hostile, BadMeshFile,
    testing::Values(
        BadMesh{"Empty", "a.ply", "", "expected 'ply'"}, BadMesh{"NoMesh", "a.txt", "hello", "PLY, OBJ, OFF or STL"},
        BadMesh{"PlyNoFormat", "a.ply", "ply\nelement vertex 1\nend_header\n", "expected a line 'format"},
        BadMesh{"PlyNoEnd", "a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "expected 'end_header'"},
        BadMesh{"PlyUnknownType", "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n",
                "line 4: expected a PLY type such as float or uchar, found 'quad'"},
        BadMesh{"PlyNoZ", "a.ply",
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
                "expected the properties x, y and z"},
        BadMesh{"PlyNoVertices", "a.ply", "ply\nformat ascii 1.0\nend_header\n", "expected 'element vertex'"},
        BadMesh{"PlyNan", "a.ply", kPlyHead + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "vertex 1: expected finite"},
        BadMesh{"PlyWord", "a.ply", kPlyHead + "0 0 0\n1 0 o\n0 1 0\n3 0 1 2\n",
                "vertex 1: expected a number, found 'o'"},
        BadMesh{"PlyIndex", "a.ply", kPlyHead + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
                "face 0: expected vertex indices below 3, found 3"},
        BadMesh{"PlyNegative", "a.ply", kPlyHead + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
                "expected a vertex index, found -1"},
        BadMesh{"PlyCutVertices", "a.ply", kPlyHead + "0 0 0\n1 0 0\n", "vertex 2: expected a number, found the end"},
        BadMesh{"PlyCutFaces", "a.ply", kPlyHead + "0 0 0\n1 0 0\n0 1 0\n3 0 1",
                "face 0: expected a number, found the end"},
        BadMesh{
            "PlyHugeCount", "a.ply",
            "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\nproperty float x\nproperty float y\n"
            "property float z\nend_header\nxxxxxxxxxxxx",
            "element vertex: expected 4000000000000 records of at least 12 bytes each, found 12 bytes"},
        BadMesh{"PlyHugeList", "a.ply",
                "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
                "float z\n"
                "element face 1\nproperty list uint int vertex_indices\nend_header\n" +
                    std::string(12, '\0') + "\xff\xff\xff\x7f",
                "face 0: expected a list that fits into the file"},
        BadMesh{"ObjNoFaces", "a.obj", "v 0 0 0\n", "found no face (1 vertices)"},
        BadMesh{"ObjIndex", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
                "line 4: expected the index of one of the 3 vertices so far, found 4"},
        BadMesh{"ObjZero", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "found 0"},
        BadMesh{"ObjShort", "a.obj", "v 0 0\n", "line 1: expected three numbers for a vertex"},
        BadMesh{"ObjNan", "a.obj", "v 0 0 inf\n", "line 1: expected finite"},
        BadMesh{"OffCut", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n",
                "the number of a face's vertices, found the end of the file"},
        BadMesh{"OffHuge", "a.off", "OFF\n300000000000 1 0\n0 0 0\n", "the file is cut"},
        BadMesh{"OffIndex", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 5\n",
                "line 6: expected vertex indices below 3, found 5"},
        BadMesh{"OffBinary", "a.off", "OFF BINARY\n", "binary"},
        BadMesh{"StlCut", "a.stl", std::string(80, ' ') + Bytes(uint32_t{1000}) + "xyz",
                "expected 50084 bytes for the 1000 triangles"},
        BadMesh{"StlShort", "a.stl", "sol", "found 3 bytes"},
        BadMesh{"StlAsciiCut", "a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
                "expected 'endsolid'"}),
    [](const auto& test) { return test.param.test; });

TEST_P(BadMeshFile, SaysFileRecordAndWhatWasExpected) {
  const TemporaryFolder folder;
  WriteFile(folder / GetParam().file, GetParam().content);
  EXPECT_THAT(ErrorOf(folder / GetParam().file), HasSubstr(GetParam().message));
}

TEST(MeshIo, MissingFilesAndFoldersAreNamed) {
  EXPECT_THAT(ErrorOf("/no/such.ply"), HasSubstr("found nothing"));
  EXPECT_THAT(ErrorOf("/tmp"), HasSubstr("found a folder"));
}

TEST(MeshIo, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  WriteMesh(folder / "a.ply", Octahedron());
  WriteMesh(folder / "a.obj", Octahedron());
  WriteFile(folder / "a.stl", BinaryStl(Octahedron(), ""));
  for (const std::string name : {"a.ply", "a.obj", "a.stl"}) {
    const std::string bytes = ReadText(folder / name);
    int num_errors = 0;
    for (size_t i = 0; i < bytes.size(); ++i) {
      std::string changed = bytes;
      changed[i] = std::array{'\xff', '-', '\n', '9'}[i % 4];
      if (i % 5 == 0) changed.resize(i);
      WriteFile(folder / name, changed);
      try {
        ReadMesh(folder / name);
      } catch (const InputError&) {
        ++num_errors;
      }
    }
    EXPECT_GT(num_errors, 20) << name;
  }
}

// --- meshes of others ---

struct Known {
  std::string file;
  size_t num_vertices, num_faces;
};

void PrintTo(const Known& known, std::ostream* out) { *out << known.file; }

class KnownMesh : public testing::TestWithParam<Known> {};

INSTANTIATE_TEST_SUITE_P(SharedData, KnownMesh,
                         testing::Values(Known{"spot.obj", 2930, 5856}, Known{"3holes.off", 3596, 7200},
                                         Known{"stanford-bunny.obj", 35947, 69451}, Known{"thingi/112932.stl", 0, 0},
                                         Known{"thingi/58011.stl", 0, 0}, Known{"truck.obj", 0, 0},
                                         Known{"teapot.obj", 3644, 6320}, Known{"beetle.obj", 0, 0},
                                         Known{"openscad-nonmanifold-crash.obj", 0, 0},
                                         Known{"decimated-knight.off", 0, 0}));

TEST_P(KnownMesh, IsReadWhole) {
  const fs::path path = fs::path(GLINT_SOURCE_DIR) / "../shared/data/meshes" / GetParam().file;
  if (!fs::exists(path)) GTEST_SKIP() << "no " << path;
  const TriangleMesh mesh = ReadMesh(path);
  RecordProperty("vertices", static_cast<int>(mesh.vertices.size()));
  if (GetParam().num_vertices > 0) {
    EXPECT_EQ(mesh.vertices.size(), GetParam().num_vertices);
    EXPECT_EQ(mesh.faces.size(), GetParam().num_faces);
  }
  EXPECT_GT(Diagonal(mesh), 0);
}

TEST(SharedData, ColmapsMeshAndPoints) {
  const fs::path data = fs::path(GLINT_SOURCE_DIR) / "../shared/data";
  if (!fs::exists(data)) GTEST_SKIP() << "no " << data;
  EXPECT_GT(ReadMesh(data / "vase/colmap-delaunay-sparse.ply").faces.size(), 1000);
  const TriangleMesh truth = ReadMesh(data / "vase/truth/gt_mesh.ply");
  EXPECT_EQ(truth.normals.size(), truth.vertices.size());
  std::vector<std::string> names;
  for (const auto& [name, values] : truth.scalars) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAre("glossy", "nviews", "nhl"));
  EXPECT_EQ(ReadPointCloud(data / "real/tumbler/sparse/0/points3D.ply").positions.size(), 9262);
}

}  // namespace
}  // namespace glint
