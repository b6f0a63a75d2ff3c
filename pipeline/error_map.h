// Where a mesh lies off a reference, and to which side: as colours on it, as a histogram, and as a sheet of pictures.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace cv {
class Mat;
}

namespace glint {

// Per vertex of a mesh, in fractions of the reference's diagonal; negative inside of it, or behind it where it is open.
struct ErrorField {
  std::vector<double> signed_rel;
  std::vector<double> area;  // world units², a third of the faces around
};
ErrorField MeasureErrors(const TriangleMesh& mesh, const TriangleMesh& reference);

// The mesh with its triangles divided into four, as often as it takes for most edges to be shorter than `edge`, so that
// colours and shares are those of the surface and not of the corners of a few large triangles. Positions and faces
// only.
TriangleMesh Divided(const TriangleMesh& mesh, double edge, size_t max_faces = 500000);

// Shares of the surface in bins of equal width over [-largest_rel, largest_rel]; what lies beyond is in `below`,
// `above`.
struct ErrorHistogram {
  double largest_rel = 0;
  std::vector<double> shares;
  double below = 0, above = 0;
};
ErrorHistogram HistogramOf(const ErrorField& field, double largest_rel, int num_bins = 40);

// 1, 2 or 5 times a power of ten that nineteen of twenty vertices of every field stay within.
double RoundErrorRange(const std::vector<ErrorField>& fields);

// From blue (inside) over white to red (outside).
std::array<uint8_t, 3> SignedErrorColor(double error, double largest);

// The mesh with its errors as colours, and as the attribute `quality` in world units, as MeshLab calls it.
TriangleMesh ColoredByError(TriangleMesh mesh, const ErrorField& field, double reference_diagonal, double largest_rel);

// One row of the sheet.
struct ErrorRow {
  std::string title;
  TriangleMesh colored;  // by ColoredByError()
  ErrorHistogram histogram;
  std::string numbers;  // a line of text beneath the histogram
};

// Each mesh from four sides (the corners of a tetrahedron) beside the histogram of its errors, and the scale.
cv::Mat ErrorSheet(const std::vector<ErrorRow>& rows);

}  // namespace glint
